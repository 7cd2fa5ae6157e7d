#include "psf/picture.h"

#include <fmt/format.h>

#include "core/error.h"
#include "film/picture.h"
#include "film/relight.h"
#include "metrics/metrics.h"
#include "metrics/reference.h"
#include "psf/library.h"

namespace psf {
namespace {

void check_size(const Picture& picture, std::size_t values, const std::string& layer) {
  if (values == picture.width * picture.height) return;
  throw Error(ErrorCode::usage,
              fmt::format("the layer {} has {} values, the picture {} x {} pixels", layer, values,
                          picture.width, picture.height));
}

film::Image to_image(const Picture& picture) {
  film::Image image;
  image.path = picture.file.empty() ? "the picture" : picture.file;
  image.width = picture.width;
  image.height = picture.height;
  for (const Layer& layer : picture.layers) {
    check_size(picture, layer.values.size(), layer.name);
    image.layers.push_back({layer.name, layer.values});
  }
  image.attributes = picture.attributes;
  return image;
}

}  // namespace

Picture to_picture(film::Image image, const std::string& camera) {
  Picture picture;
  picture.width = image.width;
  picture.height = image.height;
  picture.camera = camera;
  for (film::Layer& layer : image.layers) {
    picture.layers.push_back({std::move(layer.channel), std::move(layer.values)});
  }
  picture.attributes = std::move(image.attributes);
  return picture;
}

std::vector<Rgb> colors_of(const Picture& picture) {
  return to_image(picture).seen();
}

const std::vector<float>& Picture::layer(std::string_view name) const {
  for (const Layer& layer : layers) {
    if (layer.name == name) return layer.values;
  }
  std::string names;
  for (const Layer& layer : layers) names += (names.empty() ? "" : ", ") + layer.name;
  throw Error(ErrorCode::bad_input,
              fmt::format("the picture has no layer {}; it has {}", name, names));
}

std::vector<float> Picture::rgb(const std::string& prefix) const {
  std::vector<float> colors(3 * width * height);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::vector<float>& values = layer(prefix + "RGB"[c]);
    check_size(*this, values.size(), prefix + "RGB"[c]);
    for (std::size_t i = 0; i < values.size(); ++i) colors[3 * i + c] = values[i];
  }
  return colors;
}

std::vector<unsigned char> Picture::png(float exposure) const {
  return film::encode_png(to_image(*this), exposure);
}

std::vector<std::string> Picture::light_layers() const {
  film::Image image;
  image.attributes = attributes;
  return film::light_layers_of(image);
}

Picture Picture::relight(const std::map<std::string, std::array<float, 3>>& weights) const {
  film::LightWeights by_layer;
  for (const auto& [layer, weight] : weights) {
    by_layer[layer] = Rgb(weight[0], weight[1], weight[2]);
  }
  Picture result = to_picture(film::relight(to_image(*this), by_layer), camera);
  result.file = file;
  return result;
}

void Picture::save(const std::string& path) const {
  film::write_image(path, to_image(*this));
}

Picture Picture::read(const std::string& path, const std::string& layer) {
  const film::Picture read = film::read_picture(path, {layer, ""});
  film::Image image;
  image.width = read.width;
  image.height = read.height;
  std::vector<float> values;
  for (const Rgb& color : read.colors) values.insert(values.end(), {color.x, color.y, color.z});
  image.add("", "RGB", values);
  Picture picture = to_picture(std::move(image), "");
  picture.file = path;
  return picture;
}

double Picture::error(const Picture& reference, std::string_view metric) const {
  if (width != reference.width || height != reference.height) {
    throw Error(ErrorCode::bad_input,
                fmt::format("the picture has {} x {} pixels, the reference {} x {}", width, height,
                            reference.width, reference.height));
  }
  if (width == 0 || height == 0) throw Error(ErrorCode::usage, "the picture has no pixels");
  const metrics::Metric measured = metrics::parse_metric(metric);
  const metrics::Metric asked[] = {measured};
  return metrics::Reference(colors_of(reference), width, {}, asked)
      .measure(colors_of(*this))[measured];
}

std::vector<std::string> metric_names() {
  std::vector<std::string> names;
  names.reserve(metrics::kMetricCount);
  for (const metrics::Metric metric : metrics::kAllMetrics) names.emplace_back(name(metric));
  return names;
}

}  // namespace psf
