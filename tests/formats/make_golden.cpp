// Writes the golden files into a folder, and the hexadecimal example of formats/README.md to
// stdout.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "golden.h"
#include "golden_versions.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "psf_make_golden: give the folder to write to, sample_data\n");
    return 2;
  }
  try {
    const std::string folder = argv[1];
    psf::test::write_golden(folder + "/golden-raw.pvb", psf::formats::Codec::raw);
    psf::test::write_golden(folder + "/golden-zstd.pvb", psf::formats::Codec::zstd);
    psf::test::write_golden_tail(folder + "/golden-tail.pvb");
    psf::test::write_golden_minor(folder + "/golden-minor.pvb");
    psf::test::write_golden_major(folder + "/golden-major.pvb");
    psf::test::write_golden_required(folder + "/golden-required.pvb");
    psf::test::write_golden_swapped(folder + "/golden-swapped.pvb");
    const std::string example = folder + "/example.pvb";
    psf::test::write_example(example);
    std::fputs(psf::test::hex_dump(example).c_str(), stdout);
    std::filesystem::remove(example);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "psf_make_golden: %s\n", error.what());
    return 4;
  }
}
