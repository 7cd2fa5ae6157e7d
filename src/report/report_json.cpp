#include "report/report_json.h"

#include <fmt/format.h>

#include "core/error.h"

namespace psf::report {

JsonPlace JsonPlace::at(const study::Json& value, const std::string& name) const {
  JsonPlace place = *this;
  place.value_ = &value;
  place.path_ += "/" + name;
  return place;
}

JsonPlace JsonPlace::member(const std::string& name) const {
  expect_object();
  const auto found = value_->find(name);
  if (found == value_->end()) fail("\"" + name + "\" in it");
  return at(*found, name);
}

std::optional<JsonPlace> JsonPlace::optional_member(const std::string& name) const {
  expect_object();
  const auto found = value_->find(name);
  if (found == value_->end() || found->is_null()) return {};
  return at(*found, name);
}

JsonPlace JsonPlace::element(std::size_t index) const {
  return at((*value_)[index], std::to_string(index));
}

std::size_t JsonPlace::size() const {
  if (!value_->is_array()) fail("a list");
  return value_->size();
}

std::string JsonPlace::text() const {
  if (!value_->is_string()) fail("a text");
  return value_->get<std::string>();
}

double JsonPlace::number() const {
  if (!value_->is_number()) fail("a number");
  return value_->get<double>();
}

std::optional<double> JsonPlace::number_or_null() const {
  if (value_->is_null()) return {};
  if (!value_->is_number()) fail("a number or null");
  return value_->get<double>();
}

void JsonPlace::expect_object() const {
  if (!value_->is_object()) fail("an object");
}

void JsonPlace::expect_texts() const {
  expect_object();
  for (const auto& [name, value] : value_->items()) (void)at(value, name).text();
}

void JsonPlace::expect_numbers() const {
  expect_object();
  for (const auto& [name, value] : value_->items()) (void)at(value, name).number_or_null();
}

void JsonPlace::optional_numbers(const std::string& name) const {
  if (const auto place = optional_member(name)) place->expect_numbers();
}

void JsonPlace::optional_number(const std::string& name) const {
  if (const auto place = optional_member(name)) (void)place->number_or_null();
}

void JsonPlace::fail(const std::string& expected) const {
  throw Error(ErrorCode::bad_input, fmt::format("{}: {}: expected {}; {}", file_,
                                                path_.empty() ? "/" : path_, expected, remedy_));
}

}  // namespace psf::report
