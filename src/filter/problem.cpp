#include "filter/problem.h"

#include "filter/engine/engine.h"
#include "filter/plain.h"

namespace psf::filter {

std::unique_ptr<Engine> make_engine(EngineKind kind, const Problem& problem) {
  std::unique_ptr<Engine> engine;
  if (kind == EngineKind::flann) engine = engine::make(problem);
  return engine ? std::move(engine) : make_plain(kind, problem);
}

}  // namespace psf::filter
