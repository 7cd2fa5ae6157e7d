#include "table_file.h"

#include <numeric>

#include "golden.h"

namespace psf::test {
namespace {

const formats::Head& golden() {
  static const formats::Head head = golden_head();
  return head;
}

const formats::Channel& channel_of(std::size_t table, std::size_t channel) {
  return golden().channels.at(golden_tables().at(table).channels.at(channel));
}

std::string hex_of(const Bytes& bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    text += "0123456789abcdef"[std::to_integer<unsigned>(byte) >> 4];
    text += "0123456789abcdef"[std::to_integer<unsigned>(byte) & 15];
  }
  return text;
}

std::string line_of(const formats::Channel& channel, const Bytes& values) {
  const char* encoding = channel.encoding == formats::Encoding::plain ? "plain" : "octahedral";
  return channel.name + " " + std::string(name_of(channel.type)) + " " +
         std::to_string(channel.components) + " " + encoding + " " + hex_of(values) + "\n";
}

}  // namespace

const std::vector<GoldenTable>& golden_tables() {
  static const std::vector<GoldenTable> tables = [] {
    std::vector<std::size_t> all(golden().channels.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return std::vector<GoldenTable>{{"vertices", all, 16}, {"photons", {8, 17}, 7}};
  }();
  return tables;
}

std::vector<std::vector<pvb_channel>> table_channels() {
  const std::vector<pvb_channel> all = c_channels(golden());
  std::vector<std::vector<pvb_channel>> out;
  for (const GoldenTable& table : golden_tables()) {
    out.emplace_back();
    for (const std::size_t channel : table.channels) out.back().push_back(all.at(channel));
  }
  return out;
}

std::vector<pvb_table> c_tables(const std::vector<std::vector<pvb_channel>>& channels) {
  std::vector<pvb_table> out;
  for (std::size_t t = 0; t < channels.size(); ++t) {
    const GoldenTable& table = golden_tables().at(t);
    out.push_back({table.name.c_str(), channels[t].data(), channels[t].size(), table.capacity});
  }
  return out;
}

std::size_t table_records(std::size_t table, std::size_t pass) {
  return table == 0 ? pass % 4 * 11 : pass % 3 == 2 ? 10 : 0;
}

std::size_t records_before(std::size_t table, std::size_t pass) {
  std::size_t total = 0;
  for (std::size_t k = 0; k < pass; ++k) total += table_records(table, k);
  return total;
}

Bytes table_values(std::size_t table, std::size_t channel, std::size_t first, std::size_t count) {
  return golden_values(golden_tables().at(table).channels.at(channel), 100000 * (table + 1) + first,
                       count);
}

pvb_file* create_tables(const std::string& path) {
  const formats::Uuid uuid = golden_uuid();
  const pvb_options options = {kGoldenCapacity, 1, uuid.data()};
  const auto channels = c_channels(golden());
  const auto of_tables = table_channels();
  const auto tables = c_tables(of_tables);
  return pvb_create_with(path.c_str(), channels.data(), channels.size(), tables.data(),
                         tables.size(), golden().metadata.c_str(), &options);
}

pvb_file* resume_tables(const std::string& path) {
  const pvb_options options = {0, 1, nullptr};
  const auto channels = c_channels(golden());
  const auto of_tables = table_channels();
  const auto tables = c_tables(of_tables);
  return pvb_resume_with(path.c_str(), channels.data(), channels.size(), tables.data(),
                         tables.size(), golden().metadata.c_str(), &options);
}

int append_tables(pvb_file* file, std::size_t pass) {
  append_golden(file, pass * kGoldenPass, kGoldenPass);
  int result = 0;
  for (std::size_t t = 0; t < golden_tables().size(); ++t) {
    const std::size_t count = table_records(t, pass);
    std::vector<Bytes> columns;
    std::vector<pvb_array> arrays;
    for (std::size_t k = 0; k < golden_tables()[t].channels.size(); ++k) {
      columns.push_back(table_values(t, k, records_before(t, pass), count));
      arrays.push_back({columns.back().data(), channel_of(t, k).stride()});
    }
    result = pvb_append_to(file, t, count, arrays.data());
  }
  return result;
}

int write_tables_pass(pvb_file* file, std::size_t pass) {
  append_tables(file, pass);
  const std::string state = "resume " + std::to_string(pass);
  return pvb_commit(file, state.data(), state.size());
}

void write_tables(const std::string& path, std::size_t passes, bool close) {
  const CFile file(create_tables(path));
  for (std::size_t pass = 0; pass < passes; ++pass) write_tables_pass(file.get(), pass);
  if (close) pvb_close(file.get());
}

Bytes c_read_from(pvb_file* file, std::size_t table, std::size_t channel, std::uint64_t first,
                  std::size_t count) {
  const std::size_t stride = channel_of(table, channel).stride();
  Bytes out(count * stride);
  if (pvb_read_from(file, table, channel, first, count, out.data(), stride) != 0) out.clear();
  return out;
}

std::string table_faults(const std::string& path, std::size_t passes) {
  const CFile file(pvb_open(path.c_str()));
  if (!file.error().empty()) return file.error();
  if (file.info().passes != passes) return "passes: " + std::to_string(file.info().passes);
  if (file.info().records != passes * kGoldenPass) return "records of the paths";
  for (std::size_t k = 0; k < golden().channels.size(); ++k) {
    const Bytes values = c_read(file.get(), k, 0, passes * kGoldenPass);
    if (values != golden_values(k, 0, passes * kGoldenPass)) return golden().channels[k].name;
  }
  if (file.info().table_count != golden_tables().size()) return "number of tables";
  for (std::size_t t = 0; t < golden_tables().size(); ++t) {
    const std::size_t records = records_before(t, passes);
    if (file.info().tables[t].records != records) return "records of " + golden_tables()[t].name;
    for (std::size_t k = 0; k < golden_tables()[t].channels.size(); ++k) {
      if (c_read_from(file.get(), t, k, 0, records) != table_values(t, k, 0, records)) {
        return golden_tables()[t].name + ": " + channel_of(t, k).name + file.error();
      }
    }
    for (std::size_t pass = 0; pass < passes; ++pass) {
      std::uint64_t first = 0, count = 0;
      if (pvb_pass_of(file.get(), t, pass, &first, &count) != 0) return file.error();
      if (count != table_records(t, pass) || first != records_before(t, pass)) return "a pass";
    }
  }
  return file.error();
}

std::string tables_dump(std::size_t passes) {
  std::string text;
  for (std::size_t k = 0; k < golden().channels.size(); ++k) {
    text += line_of(golden().channels[k], golden_values(k, 0, passes * kGoldenPass));
  }
  for (std::size_t t = 0; t < golden_tables().size(); ++t) {
    text += "table: " + golden_tables()[t].name;
    for (std::size_t k = 0; k < passes; ++k) text += " " + std::to_string(table_records(t, k));
    text += "\n";
    for (std::size_t k = 0; k < golden_tables()[t].channels.size(); ++k) {
      text += line_of(channel_of(t, k), table_values(t, k, 0, records_before(t, passes)));
    }
  }
  return text;
}

}  // namespace psf::test
