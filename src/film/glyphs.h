// The shapes of the printable letters of ASCII, as strokes of a pen: what lettering.h draws.
#pragma once

#include <array>

namespace psf::film {

// From the space on. Strokes have spaces between; a stroke is a list of points of two digits, x and
// y in base 36, y downward: capitals begin at 0, small letters at 4, both stand on e and reach down
// to i. A line goes from point to point; behind "~" it is the quadratic B-spline of the points,
// which begins and ends where they do.
inline constexpr char kFirstGlyph = ' ';
inline constexpr std::array<const char*, 95> kGlyphs = {
    "",                                  // space
    "0009 0e0e",                         // !
    "0004 3034",                         // "
    "301e 705e 0585 0989",               // #
    "~83800007878e0e0b 404e",            // $
    "801e ~204044040020 ~7a9a9e5e5a7a",  // %
    "~8e14106064080e6e88",               // &
    "0004",                              // '
    "~30030d3g",                         // (
    "~00333d0g",                         // )
    "3137 0266 0662",                    // *
    "454d 0989",                         // +
    "1d0g",                              // ,
    "0959",                              // -
    "0e0e",                              // .
    "600f",                              // /
    "~30707e0e0030",                     // 0
    "03404e",                            // 1
    "~040080860e 0e8e",                  // 2
    "~0300707737 ~37878e0e0b",           // 3
    "6e600a8a",                          // 4
    "701006 ~06848e0e0b",                // 5
    "~7020080a ~46868e0e0646",           // 6
    "00803e",                            // 7
    "~407077171040 ~47878e0e0747",       // 8
    "~408088080040 ~84866e1e",           // 9
    "0606 0e0e",                         // :
    "1616 1d0g",                         // ;
    "74097e",                            // <
    "0787 0b8b",                         // =
    "04790e",                            // >
    "~03007076363a 3e3e",                // ?
    "~9e0e00a0aa7a75 ~54747a3a3454",     // @
    "0e408e 2969",                       // A
    "0e00 ~004070774707 ~0747878e4e0e",  // B
    "~8480000e8e8a",                     // C
    "000e ~0030808e3e0e",                // D
    "70000e7e 0767",                     // E
    "70000e 0767",                       // F
    "~8480000e8e8a 8a8858",              // G
    "000e 808e 0787",                    // H
    "000e",                              // I
    "~60686e0e0a",                       // J
    "000e 8009 368e",                    // K
    "000e7e",                            // L
    "0e0059a0ae",                        // M
    "0e008e80",                          // N
    "~40808e0e0040",                     // O
    "0e00 ~004080884808",                // P
    "~40808e0e0040 5b9f",                // Q
    "0e00 ~004080884808 488e",           // R
    "~83800007878e0e0b",                 // S
    "0080 404e",                         // T
    "~00090e8e8980",                     // U
    "004e80",                            // V
    "003e629ec0",                        // W
    "008e 800e",                         // X
    "004780 474e",                       // Y
    "00800e8e",                          // Z
    "30000g3g",                          // [
    "006f",                              // backslash
    "00303g0g",                          // ]
    "043064",                            // ^
    "0f8f",                              // _
    "0022",                              // `
    "~060474787e ~78080e7e7b",           // a
    "000e ~44848e0e0444",                // b
    "~7774040e7e7b",                     // c
    "808e ~44848e0e0444",                // d
    "0989 ~8984040e8e8c",                // e
    "~6020242e 0454",                    // f
    "~44848e0e0444 ~848c8i1i0g",         // g
    "000e ~0a04747a7e",                  // h
    "040e 0000",                         // i
    "~343c3i0i 3030",                    // j
    "000e 740b 387e",                    // k
    "~000a0e3e",                         // l
    "040e ~0a04646a6e ~6a64c4cace",      // m
    "040e ~0a04747a7e",                  // n
    "~44848e0e0444",                     // o
    "040i ~44848e0e0444",                // p
    "848i ~44848e0e0444",                // q
    "040e ~0a0454",                      // r
    "~76740409797e0e0c",                 // s
    "~212a2e6e 0464",                    // t
    "~04080e7e78 747e",                  // u
    "044e84",                            // v
    "043e669ec4",                        // w
    "047e 740e",                         // x
    "044e 842i",                         // y
    "04740e7e",                          // z
    "~40202808 ~08282g4g",               // {
    "000g",                              // |
    "~00202848 ~48282g0g",               // }
    "~0a276b87",                         // ~
};

}  // namespace psf::film
