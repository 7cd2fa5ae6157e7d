// What psf info tells, as JSON.
#include <nlohmann/json.hpp>

#include "info_report.h"

namespace psf::tools {
namespace {

nlohmann::ordered_json channels_json(const TableInfo& info) {
  using Json = nlohmann::ordered_json;
  const auto& [table, sizes, statistics] = info;
  Json channels = Json::array();
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const formats::Channel& channel = table.schema().channels[k];
    Json entry = {
        {"name", channel.name},
        {"type", name_of(channel.type)},
        {"components", channel.components},
        {"encoding", channel.encoding == formats::Encoding::plain ? "plain" : "octahedral"},
        {"raw_bytes", sizes[k].raw},
        {"stored_bytes", sizes[k].stored},
        {"ratio", stored_share(sizes[k])}};
    if (!statistics.empty()) {
      Json components = Json::array();
      for (const formats::ComponentStatistics& of : statistics[k]) {
        components.push_back({{"min", of.min},  // null where no value is finite
                              {"max", of.max},
                              {"mean", of.mean()},
                              {"finite", of.finite},
                              {"non_finite", of.non_finite}});
      }
      entry["statistics"] = std::move(components);
    }
    channels.push_back(std::move(entry));
  }
  return channels;
}

nlohmann::ordered_json passes_json(const formats::TableReader& table) {
  nlohmann::ordered_json passes = nlohmann::ordered_json::array();
  for (const formats::Pass& pass : table.passes()) {
    passes.push_back({{"first_record", pass.first}, {"records", pass.count}});
  }
  return passes;
}

}  // namespace

nlohmann::ordered_json describe_file(const formats::Reader& reader,
                                     const std::vector<TableInfo>& infos) {
  using Json = nlohmann::ordered_json;
  Json tables = Json::array();
  for (std::size_t k = 1; k < infos.size(); ++k) {
    const formats::TableReader& table = infos[k].table;
    tables.push_back({{"name", table.name()},
                      {"records", table.records()},
                      {"chunks", table.chunks().size()},
                      {"passes", passes_json(table)},
                      {"channels", channels_json(infos[k])}});
  }
  return {{"file", reader.path()},
          {"version", {reader.head().major, reader.head().minor}},
          {"uuid", reader.uuid()},
          {"closed", reader.closed()},
          {"records", reader.records()},
          {"chunks", reader.chunks().size()},
          {"file_bytes", reader.file_bytes()},
          {"uncommitted_bytes", reader.uncommitted_bytes()},
          {"passes", passes_json(infos[0].table)},
          {"channels", channels_json(infos[0])},
          {"tables", std::move(tables)},
          {"metadata", Json(nlohmann::json::parse(reader.head().metadata))}};
}

}  // namespace psf::tools
