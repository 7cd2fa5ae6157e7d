#include "tabled.h"

#include <algorithm>
#include <cstring>
#include <span>

#include "numbered.h"

namespace psf::test {
namespace {

using formats::Type;

constexpr std::uint64_t kNumberStep = 1000;  // of a pass

std::vector<std::uint64_t> numbers_in(std::size_t table, std::uint64_t pass) {
  return numbers_from(pass * kNumberStep, tabled_count(table, pass));
}

void append_part(formats::Writer& writer, std::size_t table,
                 const std::vector<std::uint64_t>& numbers) {
  std::vector<std::vector<std::byte>> columns;
  std::vector<const void*> pointers;
  for (std::size_t k = 0; k < writer.head().schema(table).channels.size(); ++k) {
    columns.push_back(tabled_values(table, k, numbers));
  }
  for (const auto& column : columns) pointers.push_back(column.data());
  writer.append_to(table, numbers.size(), pointers);
}

}  // namespace

std::size_t tabled_count(std::size_t table, std::uint64_t pass) {
  if (table == 1) return 31 + pass % 5;
  return pass % 3 == 1 ? 9 : 0;
}

formats::Head tabled_head() {
  formats::Head head = numbered_head();
  formats::Table marks, rare;
  marks.name = "marks";
  marks.chunk_capacity = 16;
  marks.channels = {{"number", Type::u64, 1},
                    {"path", Type::u32, 1},
                    {"value", Type::f32, 3},
                    {"depth", Type::u16, 1}};
  rare.name = "rare";
  rare.chunk_capacity = 4;
  rare.channels = {{"number", Type::u64, 1}, {"position", Type::f64, 3}};
  head.tables = {marks, rare};
  return head;
}

std::vector<std::byte> tabled_values(std::size_t table, std::size_t channel,
                                     const std::vector<std::uint64_t>& numbers) {
  const formats::Channel of = tabled_head().schema(table).channels.at(channel);
  std::vector<std::byte> out(numbers.size() * of.stride());
  std::byte* to = out.data();
  for (const std::uint64_t number : numbers) {
    for (std::size_t c = 0; c < of.components; ++c) {
      const std::uint64_t bits =
          channel == 0 ? number : (number + 1) * (7 * c + 3 * channel + table);
      const auto f = static_cast<float>(bits) * 0.25f;
      const auto d = static_cast<double>(bits) / 3;
      const void* from = of.type == Type::f32   ? static_cast<const void*>(&f)
                         : of.type == Type::f64 ? static_cast<const void*>(&d)
                                                : static_cast<const void*>(&bits);
      std::memcpy(to, from, size_of(of.type));
      to += size_of(of.type);
    }
  }
  return out;
}

void append_tabled(formats::Writer& writer) {
  const std::uint64_t pass = writer.passes();
  const auto marks = numbers_in(1, pass), rare = numbers_in(2, pass);
  const auto middle = marks.begin() + static_cast<std::ptrdiff_t>(marks.size() / 2);
  append_part(writer, 1, {marks.begin(), middle});
  append_numbered(writer, pass * kNumberedPass, kNumberedPass / 2);
  append_part(writer, 2, rare);
  append_numbered(writer, pass * kNumberedPass + kNumberedPass / 2, kNumberedPass / 2);
  append_part(writer, 1, {middle, marks.end()});
}

void write_tabled(formats::Writer& writer, std::uint64_t last) {
  while (writer.passes() < last) {
    append_tabled(writer);
    const std::string state = numbered_state(writer.passes() + 1);
    writer.commit(std::as_bytes(std::span(state)));
  }
}

void write_tabled_file(const std::string& path, formats::Codec codec, std::uint64_t passes) {
  formats::Writer writer(path, tabled_head(), {codec, false, {}});
  write_tabled(writer, passes);
  writer.close();
}

std::vector<std::uint64_t> numbers_of(const formats::TableReader& table) {
  std::vector<std::uint64_t> numbers(table.records());
  table.read(0, 0, numbers.size(), std::as_writable_bytes(std::span(numbers)));
  return numbers;
}

std::size_t wrong_table_columns(const formats::Reader& reader) {
  std::size_t wrong = 0;
  for (std::size_t t = 1; t < reader.head().table_count(); ++t) {
    const formats::TableReader& table = reader.table(t);
    const std::vector<std::uint64_t> numbers = numbers_of(table);
    for (std::size_t k = 0; k < table.schema().channels.size(); ++k) {
      std::vector<std::byte> values(numbers.size() * table.schema().channels[k].stride());
      table.read(k, 0, numbers.size(), values);
      if (values != tabled_values(t, k, numbers)) ++wrong;
    }
  }
  return wrong;
}

bool holds_tables(const formats::Reader& reader, std::uint64_t passes) {
  if (reader.head().table_count() != 3) return false;
  for (std::size_t t = 1; t < 3; ++t) {
    std::vector<std::uint64_t> expected;
    const formats::TableReader& table = reader.table(t);
    if (table.passes().size() != passes) return false;
    for (std::uint64_t pass = 0; pass < passes; ++pass) {
      const formats::Pass& of = table.passes()[pass];
      if (of.first != expected.size() || of.count != tabled_count(t, pass)) return false;
      const auto more = numbers_in(t, pass);
      expected.insert(expected.end(), more.begin(), more.end());
    }
    if (numbers_of(table) != expected) return false;
  }
  return wrong_table_columns(reader) == 0;
}

}  // namespace psf::test
