// A path tracer in a hundred lines that writes a path-vertex buffer: a ball under a bright window.
//
//   cc -O2 sphere.c -lm -o sphere
//   ./sphere out.pvb 16 512           16 passes, 512 pixels wide; again, and the file has 32
//   psf filter out.pvb -o out.png
#define PVB_IMPLEMENTATION
#include "pvb.h"
// clang-format off
#include <math.h>

typedef struct { float x, y, z; } vec;
typedef struct { float t; vec x, n, rho; } hit;
typedef struct {
  vec position, normal, reflectance, throughput, contribution, unfiltered;
  float distance;
  uint32_t pixel;
  uint8_t flags;
} record;

static vec add(vec a, float s, vec b) { return (vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z}; }
static vec times(vec a, vec b) { return (vec){a.x * b.x, a.y * b.y, a.z * b.z}; }
static float dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec unit(vec a) { return add((vec){0, 0, 0}, 1 / sqrtf(dot(a, a)), a); }
static float uniform(uint64_t *state) {  // SplitMix64, in [0, 1)
  uint64_t z = *state += 0x9E3779B97F4A7C15u;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
  z = (z ^ z >> 27) * 0x94D049BB133111EBu;
  return (float)((z ^ z >> 31) >> 40) * 0x1p-24f;
}

static vec sky(vec d) {  // the window takes 3.5% of all directions
  return dot(d, (vec){0.48f, 0.8f, 0.36f}) > 0.93f ? (vec){9, 8, 6.5f} : (vec){0.12f, 0.16f, 0.24f};
}

static int intersect(vec o, vec d, hit *h) {  // what the ray meets first; 0: the sky
  const vec center = {0, 1, 0}, to = add(o, -1, center);
  const float b = dot(to, d), square = b * b - dot(to, to) + 1;
  const float ground = d.y < 0 ? -o.y / d.y : 30, far = square > 0 ? -b - sqrtf(square) : 30;
  const int ball = far > 0 && far < ground;
  h->t = ball ? far : ground;
  h->x = add(o, h->t, d);
  h->n = ball ? unit(add(h->x, -1, center)) : (vec){0, 1, 0};
  const float tile = fabsf(fmodf(floorf(h->x.x) + floorf(h->x.z), 2));  // 0 or 1
  h->rho = ball ? (vec){0.75f, 0.3f, 0.2f} : (vec){0.2f + 0.5f * tile, 0.3f + 0.4f * tile, 0.5f};
  return h->t < 30;
}

static vec reflected(hit h, uint64_t *state) {  // radiance, by one path of at most five segments
  vec weight = {1, 1, 1};
  for (int bounce = 0; bounce < 5; ++bounce) {
    const float z = 1 - 2 * uniform(state), r = sqrtf(1 - z * z), phi = 6.2831853f * uniform(state);
    const vec d = unit(add(h.n, 0.9999f, (vec){r * cosf(phi), r * sinf(phi), z}));  // cosine lobe
    weight = times(weight, h.rho);
    if (!intersect(add(h.x, 1e-3f, h.n), d, &h)) return times(weight, sky(d));
  }
  return (vec){0, 0, 0};
}

static record trace(uint64_t path, uint32_t width, uint32_t height) {
  uint64_t state = path * 0xD1342543DE82EF95u;  // by the path's number, so that resuming is exact
  const uint32_t pixel = path % (width * height) & UINT32_MAX;
  const float x = (float)(pixel % width) + uniform(&state) - 0.5f * (float)width;
  const float y = (float)(pixel / width) + uniform(&state) - 0.5f * (float)height;
  const vec d = unit((vec){x, -y, -1.1f * (float)width});
  hit h;
  if (!intersect((vec){0, 1.1f, 5}, d, &h)) return (record){.unfiltered = sky(d), .pixel = pixel};
  return (record){h.x, h.n, h.rho, {1, 1, 1}, reflected(h, &state), {0, 0, 0}, h.t, pixel,
                  PVB_HAS_VERTEX | PVB_IS_SHADED};
}

int main(int argc, char **argv) {
  static const pvb_channel channels[] = {PVB_POSITION, PVB_NORMAL, PVB_REFLECTANCE, PVB_THROUGHPUT,
      PVB_CONTRIBUTION, PVB_UNFILTERED, PVB_DISTANCE, PVB_PIXEL, PVB_FLAGS, PVB_VISIBILITY};
  static const uint32_t no_lights = 0;  // none has a name, so no bit of `visibility` is anyone's
  const char *name = argc > 1 ? argv[1] : "sphere.pvb";
  const unsigned passes = argc > 2 ? strtoul(argv[2], NULL, 10) & 0xFFFFFF : 16;
  const unsigned width = argc > 3 ? strtoul(argv[3], NULL, 10) & 0xFFF : 512;
  const unsigned height = width * 3 / 4, count = width * height;
  char text[256];
  snprintf(text, sizeof text, "{\"producer\":\"sphere\",\"enumeration\":\"pixel\",\"cameras\":[{"
           "\"name\":\"main\",\"width\":%u,\"height\":%u,\"angle_per_pixel\":%.9g}]}",
           width, height, 1 / (1.1 * width));
  record *r = malloc(count * sizeof *r);
  pvb_file *file = access(name, F_OK) == 0 ? pvb_resume(name, channels, 10, text, NULL)
                                           : pvb_create(name, channels, 10, text, NULL);
  for (uint32_t pass = 0; pass < passes && r != NULL && pvb_error(file) == NULL; ++pass) {
    for (uint32_t i = 0; i < count; ++i) r[i] = trace(pvb_about(file)->records + i, width, height);
    const pvb_array arrays[] = {PVB_FIELD(r, position), PVB_FIELD(r, normal),
        PVB_FIELD(r, reflectance), PVB_FIELD(r, throughput), PVB_FIELD(r, contribution),
        PVB_FIELD(r, unfiltered), PVB_FIELD(r, distance), PVB_FIELD(r, pixel), PVB_FIELD(r, flags),
        {&no_lights, 0}};
    if (pvb_append(file, count, arrays) == 0) pvb_commit(file, NULL, 0);
  }
  const int code = pvb_close(file);  // an error of any call above is told here
  if (code != 0) fprintf(stderr, "sphere: %s\n", pvb_error(file));
  pvb_free(file);
  free(r);
  return code;
}
