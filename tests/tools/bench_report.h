// What psf-bench writes for programs, by the names of its rows.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace psf::tests {

inline std::map<std::string, nlohmann::json> rows_of(const nlohmann::json& report) {
  std::map<std::string, nlohmann::json> rows;
  for (const auto& row : report.at("rows")) rows[row.at("name")] = row;
  return rows;
}

}  // namespace psf::tests
