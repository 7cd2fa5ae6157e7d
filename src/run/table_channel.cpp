#include "run/table_channel.h"

#include <fmt/format.h>

#include "core/error.h"

namespace psf::run {

std::size_t table_channel(const formats::Reader& reader, const formats::TableReader& table,
                          std::string_view name, formats::Type type, std::size_t components,
                          std::string_view wanted_by) {
  using formats::Type;
  const std::size_t place = table.require(name, wanted_by);
  const formats::Channel& channel = table.schema().channels[place];
  const bool is_float = channel.type == Type::f16 || channel.type == Type::f32 ||
                        channel.type == Type::f64 ||
                        channel.encoding == formats::Encoding::octahedral;
  const bool fits = type == Type::f32 ? is_float : channel.type == type;
  if (fits && channel.decoded_components() == components) return place;
  throw Error(ErrorCode::bad_input,
              fmt::format("{}: table {}: channel {} is {} x {}, expected {} x {}; see "
                          "formats/README.md",
                          reader.path(), table.name(), name, formats::name_of(channel.type),
                          channel.components, formats::name_of(type), components));
}

}  // namespace psf::run
