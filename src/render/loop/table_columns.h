// Rows of a table of the path-vertex buffer, from structs to columns.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include "formats/layout/head.h"
#include "formats/write/writer.h"

namespace psf::render {

// A channel, and where a row has its value: components one behind the other, of the channel's type.
template <class Row>
struct TableColumn {
  formats::Channel channel;
  const void* (*value)(const Row&);
};

template <class Row>
[[nodiscard]] formats::Table table_of(const char* name,
                                      const std::vector<TableColumn<Row>>& columns) {
  formats::Table table;
  table.name = name;
  for (const TableColumn<Row>& column : columns) table.channels.push_back(column.channel);
  return table;
}

// Appends rows to the current pass of table number `table`, as formats::Head::schema() counts.
template <class Row>
void append_rows(formats::Writer& writer, std::size_t table, std::span<const Row> rows,
                 const std::vector<TableColumn<Row>>& columns) {
  std::vector<std::vector<std::byte>> values(columns.size());
  std::vector<const void*> pointers;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const std::size_t stride = columns[k].channel.stride();
    values[k].resize(rows.size() * stride);
    std::byte* to = values[k].data();
    for (const Row& row : rows) {
      std::memcpy(to, columns[k].value(row), stride);
      to += stride;
    }
    pointers.push_back(values[k].data());
  }
  writer.append_to(table, rows.size(), pointers);
}

}  // namespace psf::render
