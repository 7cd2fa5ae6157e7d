// The directory of the frame HEAD.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "formats/layout/head.h"

namespace psf::formats {

[[nodiscard]] std::vector<std::byte> encode_head(const Head& head);
// Throws Error{bad_input} that says what is wrong, or which later version wrote the file (the
// caller adds the file's name).
[[nodiscard]] Head decode_head(std::span<const std::byte> directory);

// A uuid as text: "0c0ffee0-0000-4000-8000-000000000001".
[[nodiscard]] std::string to_text(const Uuid& uuid);
// A random uuid (version 4).
[[nodiscard]] Uuid make_uuid();

}  // namespace psf::formats
