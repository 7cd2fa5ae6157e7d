// Faults of a path-vertex buffer as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "formats/check/check.h"

namespace psf::tools {

inline nlohmann::ordered_json faults_to_json(const std::vector<formats::Fault>& faults) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const formats::Fault& fault : faults) {
    nlohmann::ordered_json entry = {{"offset", fault.offset}, {"frame", fault.frame}};
    if (!fault.table.empty()) entry["table"] = fault.table;
    if (fault.chunk) entry["chunk"] = *fault.chunk;
    if (!fault.channel.empty()) entry["channel"] = fault.channel;
    if (fault.records > 0) {
      entry["first_record"] = fault.first;
      entry["records"] = fault.records;
    }
    entry["message"] = fault.message;
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace psf::tools
