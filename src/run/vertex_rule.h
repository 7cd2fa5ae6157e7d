// Which vertex of a path is x_i, where a dump has all vertices.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace psf::run {

struct VertexRule {
  enum class Kind : std::uint8_t {
    first_rough,  // the renderer's choice
    depth,        // the vertex with `value` vertices before it
    roughness,    // the first at least this rough
    distance      // the first that ends a way of at least this length, in world units
  };
  Kind kind = Kind::first_rough;
  double value = 0;

  bool operator==(const VertexRule&) const = default;
};

// "first-rough", "depth:1", "roughness:0.5", "distance:20". Throws Error{usage} that says what may
// be written.
[[nodiscard]] VertexRule parse_vertex_rule(const std::string& text);
[[nodiscard]] std::string to_text(const VertexRule& rule);

// The same of an option that may not be given: empty is no rule.
[[nodiscard]] std::optional<VertexRule> vertex_rule_of(const std::string& text);

}  // namespace psf::run
