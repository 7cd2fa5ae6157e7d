// pvb.h: writes and reads path-vertex buffers (.pvb, version 1), one file for C99 and C++11 on.
//
// For renderers that write dumps for path space filtering. It needs the C library and POSIX, links
// nothing, and knows nothing but the format (README.md beside it is the specification). It writes
// and reads raw columns; `psf cat --codec zstd` makes a file smaller afterwards.
//
// In ONE source file of yours, above every other `#include`:
//
//     #define PVB_IMPLEMENTATION
//     #include "pvb.h"
//
// Everywhere else include it without the definition. A renderer then writes, in C or C++:
//
//     struct record { float position[3], throughput[3], contribution[3], distance; uint32_t pixel; };
//     const pvb_channel channels[] = {PVB_POSITION, PVB_THROUGHPUT, PVB_CONTRIBUTION, PVB_DISTANCE,
//                                     PVB_PIXEL};
//     pvb_file *file = pvb_create("out.pvb", channels, 5,
//         "{\"enumeration\":\"pixel\",\"cameras\":[{\"width\":640,\"height\":480,"
//         "\"angle_per_pixel\":0.0015}]}", NULL);
//     for (int pass = 0; pass < 16; ++pass) {
//       struct record *r = trace_pass(pass);  // one record per path, in the order of the paths
//       const pvb_array arrays[] = {PVB_FIELD(r, position), PVB_FIELD(r, throughput),
//                                   PVB_FIELD(r, contribution), PVB_FIELD(r, distance),
//                                   PVB_FIELD(r, pixel)};
//       pvb_append(file, 640 * 480, arrays);
//       pvb_commit(file, NULL, 0);  // from here on this pass survives a kill
//     }
//     if (pvb_close(file) != 0) fprintf(stderr, "%s\n", pvb_error(file));
//     pvb_free(file);
//
// The values of a path, in short; README.md, "From what a renderer has", explains them in full and
// has an example with numbers:
//
// - unfiltered + throughput x contribution is the radiance that the path brings to its one pixel,
//   with weight 1. Reconstruction filters that splat a path into several pixels have no place here:
//   write the pixel that the camera ray goes through.
// - throughput: product of f |cos| / pdf over the vertices before x_i, mirrors and glass, over the
//   probability of each choice there; contribution: what x_i scatters, direct and indirect, without
//   its emission, which goes to unfiltered, times throughput.
// - A Russian roulette's weight, 1 / probability, belongs to what comes after it: to throughput
//   where it was played before x_i, to contribution from x_i on.
// - visibility: bit l mod 32 is set where the shadow ray from x_i to the sampled point of light l
//   met nothing. It says which lights are seen, not how much they add.
//
// sphere.c beside it is a whole renderer that does so, and resumes.
//
// Errors. A call returns 0, or one of PVB_USAGE, PVB_BAD_INPUT, PVB_IO, PVB_LIMIT, which suit as
// exit codes. In a file being written the first error sticks: every later call does nothing and
// returns it again, so it is enough to look once, at the end. The last commit stays readable
// whatever fails. pvb_error() gives one line of text: file, place, remedy.
//
// Threads. A pvb_file is used by one thread at a time. Different ones are independent.

#ifndef PVB_H_INCLUDED
#define PVB_H_INCLUDED

#ifdef PVB_IMPLEMENTATION
// The features of the system that the implementation needs. The definitions work only above the
// first system header, hence "above every other `#include`".
#ifndef _POSIX_C_SOURCE
#define _POSIX_C_SOURCE 200809L
#endif
#ifndef _FILE_OFFSET_BITS
#define _FILE_OFFSET_BITS 64
#endif
#if defined(__APPLE__) && !defined(_DARWIN_C_SOURCE)
#define _DARWIN_C_SOURCE 1
#endif
#endif

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// ---- Channels -----------------------------------------------------------------------------------

// Scalar types of a component. A half (PVB_F16) is handed over as its 16 bits.
enum { PVB_U8 = 1, PVB_U16, PVB_U32, PVB_U64, PVB_F16, PVB_F32, PVB_F64 };

// PVB_OCTAHEDRAL: a unit vector as PVB_U16 x 2, coded by the caller as the specification says.
enum { PVB_PLAIN = 0, PVB_OCTAHEDRAL = 1 };

// A channel: its name, and what a record holds of it. Those of version 1 have definitions below; the
// first five are required. README.md, "Channels", has the exact meaning of each.
typedef struct pvb_channel {
  const char* name;  // 1 to 56 characters '!' to '~', unique in the file
  int type;          // PVB_U8 ... PVB_F64
  int components;    // a record: 1 to 16
  int encoding;      // PVB_PLAIN or PVB_OCTAHEDRAL
} pvb_channel;

// clang-format off
#define PVB_POSITION {"position", PVB_F32, 3, PVB_PLAIN}            // x_i, world units
#define PVB_THROUGHPUT {"throughput", PVB_F32, 3, PVB_PLAIN}        // alpha_i
#define PVB_CONTRIBUTION {"contribution", PVB_F32, 3, PVB_PLAIN}    // c_i, radiance
#define PVB_DISTANCE {"distance", PVB_F32, 1, PVB_PLAIN}            // d_i, world units
#define PVB_PIXEL {"pixel", PVB_U32, 1, PVB_PLAIN}                  // y * width + x
#define PVB_UNFILTERED {"unfiltered", PVB_F32, 3, PVB_PLAIN}        // u_i, radiance
#define PVB_FLAGS {"flags", PVB_U8, 1, PVB_PLAIN}                   // its bits are below
#define PVB_NORMAL {"normal", PVB_F32, 3, PVB_PLAIN}                // unit normal at x_i
#define PVB_REFLECTANCE {"reflectance", PVB_F32, 3, PVB_PLAIN}      // albedo at x_i
#define PVB_CAMERA {"camera", PVB_U16, 1, PVB_PLAIN}                // index in the metadata
#define PVB_VISIBILITY {"visibility", PVB_U32, 1, PVB_PLAIN}        // a bit a light
#define PVB_HIT_DISTANCE {"hit_distance", PVB_F32, 1, PVB_PLAIN}    // h_i, world units
#define PVB_DIRECTION {"direction", PVB_F32, 3, PVB_PLAIN}          // unit, toward the camera
#define PVB_MATERIAL {"material", PVB_U32, 1, PVB_PLAIN}            // a number a material
#define PVB_ROUGHNESS {"roughness", PVB_F32, 1, PVB_PLAIN}          // in [0, 1]
#define PVB_FILM {"film", PVB_F32, 2, PVB_PLAIN}                    // pixels, y down
#define PVB_LENS {"lens", PVB_F32, 2, PVB_PLAIN}                    // of the unit disk
#define PVB_TIME {"time", PVB_F32, 1, PVB_PLAIN}                    // in [0, 1], of the shutter
#define PVB_FRAME {"frame", PVB_U32, 1, PVB_PLAIN}
#define PVB_ALPHA {"alpha", PVB_F32, 1, PVB_PLAIN}                  // coverage: 0 background
#define PVB_KIND {"kind", PVB_U8, 1, PVB_PLAIN}                     // 0 surface 1 curve 2 volume
// clang-format on

// Bits of the channel `flags`.
enum { PVB_HAS_VERTEX = 1, PVB_IS_SHADED = 2 };

// ---- Every file ---------------------------------------------------------------------------------

// The errors that a call may return; without an error it returns 0.
enum {
  PVB_USAGE = 2,      // the call is wrong
  PVB_BAD_INPUT = 3,  // the file is damaged, or not the one that is asked for
  PVB_IO = 4,         // the system refuses: permissions, full disk, another process writes it
  PVB_LIMIT = 5       // a limit of the format, or of memory
};

// A file that is written or read. It is made by pvb_create(), pvb_resume() or pvb_open() and freed by
// pvb_free().
typedef struct pvb_file pvb_file;

// What a file holds.
typedef struct pvb_info {
  uint64_t records;             // committed
  uint64_t passes;              // committed
  int closed;                   // the last commit says that the producer is done
  uint32_t chunk_capacity;      // most records per chunk
  const pvb_channel* channels;  // in the order of the file
  size_t channel_count;         // number of channels
  const char* metadata;         // JSON text, ends with a 0
  size_t metadata_size;         // bytes, without the final 0
  const void* state;            // resume state of the last commit; NULL where its checksum is wrong
  size_t state_size;            // bytes
  uint64_t uncommitted;         // bytes behind the last commit on opening; normal after a kill
} pvb_info;

// The present contents of the file. Valid until pvb_free(), `state` until the next pvb_commit().
// All values are 0 where the file could not be opened.
const pvb_info* pvb_about(const pvb_file* file);

// The error as one line, or NULL where there is none. Valid until the next call. For a NULL file it
// is "out of memory", the only reason for which a file is NULL.
const char* pvb_error(const pvb_file* file);

// Frees everything. A file that was being written and is not closed ends with its last commit and
// can be resumed; without any commit it is removed. `file` may be NULL.
void pvb_free(pvb_file* file);

// ---- Writing ------------------------------------------------------------------------------------

// How a file is written; all 0 is a good choice.
typedef struct pvb_options {
  uint32_t chunk_capacity;    // most records per chunk, 1 to 2^24; 0: 65536, or that of the file
  int no_sync;                // do not wait for the disk: a loss of power may lose commits
  const unsigned char* uuid;  // 16 bytes, to make the same file again; NULL: random
} pvb_options;

// The values of one channel: record i at `data` + i * `stride` bytes, any alignment. A stride of 0
// gives every record the same value.
typedef struct pvb_array {
  const void* data;  // the value of record 0
  size_t stride;     // bytes from one record to the next
} pvb_array;

// A member of an array of structs: `const pvb_array a[] = {PVB_FIELD(records, position), ...};`
// clang-format off
#define PVB_FIELD(records, member) {&(records)->member, sizeof *(records)}
// clang-format on

// Starts a file. It is called `path`.partial until the first commit renames it, which replaces any
// file called `path`. `metadata`: a JSON object in UTF-8, at most 1 MiB, kept byte for byte;
// README.md, "Metadata", lists the keys. It is an error if another process writes a file of this
// name. Strings and tables are copied.
pvb_file* pvb_create(const char* path, const pvb_channel* channels, size_t channel_count,
                     const char* metadata, const pvb_options* options);

// Goes on with an existing file behind its last commit, closed or not; what follows this commit is
// cut off. It is an error, and the file stays as it was, if another process writes it, it is
// damaged, or channels or metadata are not the same byte for byte. pvb_about() gives the records,
// passes and resume state so far.
pvb_file* pvb_resume(const char* path, const pvb_channel* channels, size_t channel_count,
                     const char* metadata, const pvb_options* options);

// Adds `count` records to the current pass; arrays[k] has the values of channel k. NaN and infinity
// are kept bit for bit.
int pvb_append(pvb_file* file, size_t count, const pvb_array* arrays);

// Ends the pass, which must have records, and writes it to the disk. `state`: up to 64 KiB that a
// later pvb_resume() gives back; NULL and 0 for none.
int pvb_commit(pvb_file* file, const void* state, size_t state_size);

// Marks the file as complete. It is an error if there are records that are not committed.
int pvb_close(pvb_file* file);

// ---- Reading ------------------------------------------------------------------------------------

// Opens a file up to its last commit; it may still be growing. Look at pvb_error() afterwards.
pvb_file* pvb_open(const char* path);

// Index of a channel in pvb_about()->channels, or -1.
int pvb_find(const pvb_file* file, const char* channel);

// The records of a pass, counted from 0: `*first` becomes the first record, `*count` their number.
int pvb_pass(pvb_file* file, uint64_t pass, uint64_t* first, uint64_t* count);

// Writes the records [first, first + count) of a channel to `out`, `stride` bytes apart, as stored.
// Whole columns are read, checked, and kept for the next call (one per channel). An error affects
// this call alone, names chunk and channel, and leaves `out` unchanged from the bad chunk on.
int pvb_read(pvb_file* file, size_t channel, uint64_t first, size_t count, void* out,
             size_t stride);

#ifdef __cplusplus
}
#endif

#endif  // PVB_H_INCLUDED

// =================================================================================================
#if defined(PVB_IMPLEMENTATION) && !defined(PVB_IMPLEMENTED)
#define PVB_IMPLEMENTED

#if !defined(__unix__) && !defined(__APPLE__)
#error "pvb.h needs POSIX"
#endif
#if !defined(__BYTE_ORDER__) || __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "path-vertex buffers are little-endian; big-endian hosts are not supported"
#endif

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#ifdef __cplusplus
#define PVBI_CAST(type, value) static_cast<type>(value)
#define PVBI_NULL nullptr
#else
#define PVBI_CAST(type, value) ((type)(value))
#define PVBI_NULL NULL
#endif

#ifdef __GNUC__
#define PVBI_PRINTF __attribute__((format(printf, 3, 4)))
#else
#define PVBI_PRINTF
#endif

// ---- The numbers of the specification

enum {
  PVBI_PAGE = 4096,
  PVBI_PREFIX = 64,
  PVBI_ALIGN = 64,
  PVBI_HEAD = 64,
  PVBI_CHANNEL = 64,
  PVBI_NAME = 56,
  PVBI_CHUNK = 32,
  PVBI_COLUMN = 24,
  PVBI_COMMIT = 160,
  PVBI_ENTRY = 32,
  PVBI_SLOT_RECORD = 32,
  PVBI_STEP = 64,  // which commits carry more of the index: README.md, "The index"
  PVBI_LEAP = 4096,
  PVBI_MAX_CHANNELS = 256,
  PVBI_MAX_COMPONENTS = 16,
  PVBI_MAX_STATE = 64 << 10,
  PVBI_MAX_METADATA = 1 << 20,
  PVBI_MAX_DIRECTORY = 16 << 20,
  PVBI_MAX_RECORDS = 1 << 24,  // a chunk
  PVBI_MAX_CHUNK = 1 << 30     // bytes
};

#define PVBI_TYPE(a, b, c, d) (0u | (a) | (b) << 8 | (c) << 16 | (d) << 24)
#define PVBI_TYPE_HEAD PVBI_TYPE(0x48u, 0x45u, 0x41u, 0x44u)
#define PVBI_TYPE_SLOT PVBI_TYPE(0x53u, 0x4Cu, 0x4Fu, 0x54u)
#define PVBI_TYPE_CHNK PVBI_TYPE(0x43u, 0x48u, 0x4Eu, 0x4Bu)
#define PVBI_TYPE_CMIT PVBI_TYPE(0x43u, 0x4Du, 0x49u, 0x54u)

static const unsigned char pvbi_magic[8] = {0x89, 0x50, 0x56, 0x42, 0x0D, 0x0A, 0x1A, 0x01};

enum { PVBI_IDLE, PVBI_READING, PVBI_WRITING, PVBI_DONE };

typedef struct pvbi_entry {  // the entry of a chunk in the index
  uint64_t offset, length, first;
  uint32_t count, pass;
} pvbi_entry;

typedef struct pvbi_frame {
  uint64_t offset, length, sequence;
  uint32_t type, flags;
  size_t size;                     // size of the directory
  const unsigned char* directory;  // in the scratch memory; valid until its next use
} pvbi_frame;

typedef struct pvbi_section {
  uint64_t offset, length;
  uint32_t crc;
} pvbi_section;

typedef struct pvbi_commit {
  uint64_t offset, length, sequence;  // those of the frame
  uint64_t number, records, chunks, passes, base, first_chunk, foreign;
  uint32_t flags;
  pvbi_section index, state;
} pvbi_commit;

typedef struct pvbi_anchor {  // a commit that the index of a later one may build on
  uint64_t offset, chunks;
} pvbi_anchor;

struct pvb_file {
  pvb_info info;
  int mode, code;  // code: that of the error; 0: no error
  char error[1024];
  uint32_t crc[16][256];
  char *path, *partial;  // partial: name until the first commit, then NULL
  int fd, replaced;      // replaced: the file that the first commit will replace, locked; or -1
  int no_sync;

  unsigned char uuid[16];
  unsigned char* head;  // the frame HEAD: prefix and directory
  size_t head_size;
  pvb_channel channels[PVBI_MAX_CHANNELS];
  char names[PVBI_MAX_CHANNELS][PVBI_NAME + 1];
  size_t bytes[PVBI_MAX_CHANNELS];  // size of a record of each channel
  char* metadata;
  unsigned char* state;

  uint64_t size;       // size of the file when it was opened; nothing is read behind it
  uint64_t slot, end;  // offsets of SLOT and of the next frame
  uint64_t sequence;   // sequence number of the next frame
  uint64_t committed_end, commits;
  pvbi_anchor previous, leap;
  pvbi_entry* index;
  size_t chunks, index_room;
  uint64_t appended;  // records in chunks that are written

  unsigned char* chunk;             // the frame being filled; columns have the places of a full one
  size_t place[PVBI_MAX_CHANNELS];  // place of each column in the frame
  uint32_t filled;                  // number of records in the frame

  unsigned char* scratch;
  size_t scratch_size;
  unsigned char* column[PVBI_MAX_CHANNELS];  // the last column that was read of each channel ...
  size_t column_chunk[PVBI_MAX_CHANNELS];    // ... and its chunk + 1; 0: none
  uint64_t* pass_first;                      // passes + 1 of them
};

// ---- Bytes, checksums, errors

static void pvbi_put32(unsigned char* to, uint32_t value) {
  int k;
  for (k = 0; k < 4; ++k) to[k] = PVBI_CAST(unsigned char, value >> 8 * k & 0xFF);
}

static void pvbi_put64(unsigned char* to, uint64_t value) {
  pvbi_put32(to, PVBI_CAST(uint32_t, value & 0xFFFFFFFFu));
  pvbi_put32(to + 4, PVBI_CAST(uint32_t, value >> 32));
}

static uint32_t pvbi_get32(const unsigned char* from) {
  const uint32_t a = from[0], b = from[1], c = from[2], d = from[3];
  return a | b << 8 | c << 16 | d << 24;
}

static uint64_t pvbi_get64(const unsigned char* from) {
  const uint64_t low = pvbi_get32(from), high = pvbi_get32(from + 4);
  return low | high << 32;
}

static uint64_t pvbi_up(uint64_t value, uint64_t alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

static void pvbi_make_crc(pvb_file* f) {
  uint32_t k, bit, slice;
  for (k = 0; k < 256; ++k) {
    uint32_t crc = k;
    for (bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xEDB88320u : 0u);
    f->crc[0][k] = crc;
  }
  for (slice = 1; slice < 16; ++slice) {
    for (k = 0; k < 256; ++k) {
      const uint32_t before = f->crc[slice - 1][k];
      f->crc[slice][k] = before >> 8 ^ f->crc[0][before & 0xFF];
    }
  }
}

// Computes the checksum, sixteen bytes per step: f->crc[s][b] is the effect of byte b after s more
// bytes. `crc`: checksum of the preceding bytes, 0 at the start.
static uint32_t pvbi_crc(const pvb_file* f, uint32_t crc, const void* data, size_t size) {
  const unsigned char* p = PVBI_CAST(const unsigned char*, data);
  crc = ~crc;
  for (; size >= 16; size -= 16, p += 16) {
    uint32_t w[4];
    memcpy(w, p, 16);
    w[0] ^= crc;
    crc = f->crc[15][w[0] & 0xFF] ^ f->crc[14][w[0] >> 8 & 0xFF] ^ f->crc[13][w[0] >> 16 & 0xFF] ^
          f->crc[12][w[0] >> 24] ^ f->crc[11][w[1] & 0xFF] ^ f->crc[10][w[1] >> 8 & 0xFF] ^
          f->crc[9][w[1] >> 16 & 0xFF] ^ f->crc[8][w[1] >> 24] ^ f->crc[7][w[2] & 0xFF] ^
          f->crc[6][w[2] >> 8 & 0xFF] ^ f->crc[5][w[2] >> 16 & 0xFF] ^ f->crc[4][w[2] >> 24] ^
          f->crc[3][w[3] & 0xFF] ^ f->crc[2][w[3] >> 8 & 0xFF] ^ f->crc[1][w[3] >> 16 & 0xFF] ^
          f->crc[0][w[3] >> 24];
  }
  for (; size > 0; --size, ++p) crc = crc >> 8 ^ f->crc[0][(crc ^ *p) & 0xFF];
  return ~crc;
}

static int pvbi_fail(pvb_file* f, int code, const char* format, ...) PVBI_PRINTF;
static int pvbi_fail(pvb_file* f, int code, const char* format, ...) {
  va_list list;
  int used = snprintf(f->error, sizeof f->error, "%.600s: ", f->path);
  f->code = code;
  if (used < 0) used = 0;
  va_start(list, format);
  (void)vsnprintf(f->error + used, sizeof f->error - PVBI_CAST(unsigned, used), format, list);
  va_end(list);
  return code;
}

// Sets the error to PVB_IO with the text of errno and a remedy.
static int pvbi_fail_io(pvb_file* f, const char* action) {
  const int error = errno;
  const char* remedy = "";
  if (error == ENOENT) remedy = "; check the name and that the folder exists";
  if (error == EACCES || error == EPERM || error == EROFS) {
    remedy = "; check the permissions or choose another folder";
  }
  if (error == ENOSPC || error == EDQUOT) remedy = "; free some space or choose another disk";
  if (error == EFBIG) remedy = "; raise the limit on file sizes (ulimit -f)";
  if (error == EMFILE || error == ENFILE) remedy = "; raise the limit on open files (ulimit -n)";
  return pvbi_fail(f, PVB_IO, "cannot %s: %s%s", action, strerror(error), remedy);
}

static int pvbi_fail_memory(pvb_file* f) {
  return pvbi_fail(f, PVB_LIMIT, "out of memory; use smaller chunks");
}

// The scratch memory with room for `size` bytes; its contents are lost. NULL where there is no
// memory.
static unsigned char* pvbi_scratch(pvb_file* f, uint64_t size) {
  if (size >= SIZE_MAX) return PVBI_NULL;
  if (f->scratch == PVBI_NULL || f->scratch_size < size) {
    free(f->scratch);
    f->scratch_size = size & SIZE_MAX;
    f->scratch = PVBI_CAST(unsigned char*, malloc(f->scratch_size + 1));
  }
  return f->scratch;
}

// ---- The file

static int pvbi_pread(pvb_file* f, uint64_t offset, void* out, size_t size) {
  unsigned char* to = PVBI_CAST(unsigned char*, out);
  while (size > 0) {
    const ssize_t got = pread(f->fd, to, size, PVBI_CAST(off_t, offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return pvbi_fail_io(f, "read");
    if (got == 0) {
      return pvbi_fail(f, PVB_IO, "ends at byte %llu: it was cut while being read", 0ull + offset);
    }
    to += got;
    size -= PVBI_CAST(size_t, got);
    offset += PVBI_CAST(uint64_t, got);
  }
  return 0;
}

static int pvbi_pwrite(pvb_file* f, uint64_t offset, const unsigned char* from, size_t size) {
  while (size > 0) {
    const ssize_t put = pwrite(f->fd, from, size, PVBI_CAST(off_t, offset));
    if (put < 0 && errno == EINTR) continue;
    if (put == 0) errno = ENOSPC;
    if (put <= 0) return pvbi_fail_io(f, "write");
    from += put;
    size -= PVBI_CAST(size_t, put);
    offset += PVBI_CAST(uint64_t, put);
  }
  return 0;
}

static int pvbi_sync(pvb_file* f) {
  if (f->no_sync) return 0;
#ifdef __APPLE__
  return fsync(f->fd) == 0 ? 0 : pvbi_fail_io(f, "sync");
#else
  return fdatasync(f->fd) == 0 ? 0 : pvbi_fail_io(f, "sync");
#endif
}

static int pvbi_same_file(const struct stat* a, const struct stat* b) {
  return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

// Opens and locks `path` for this process alone. Returns -1 and sets an error where it cannot.
static int pvbi_open_locked(pvb_file* f, const char* path, int flags) {
  int attempt;
  for (attempt = 0; attempt < 100; ++attempt) {
    struct stat locked, named;
    const int fd = open(path, flags | O_CLOEXEC | O_NONBLOCK, 0666);
    if (fd < 0) {
      pvbi_fail_io(f, (flags & O_CREAT) != 0 ? "create" : "open");
      return -1;
    }
    if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) break;
      pvbi_fail_io(f, "lock");
      close(fd);
      return -1;
    }
    if (fstat(fd, &locked) == 0 && stat(path, &named) == 0 && pvbi_same_file(&locked, &named)) {
      if (S_ISREG(locked.st_mode)) return fd;
      close(fd);
      pvbi_fail(f, PVB_IO, "is not a regular file; choose another name");
      return -1;
    }
    // Between open and lock, another process finished the file and renamed it. Leave it alone.
    close(fd);
  }
  pvbi_fail(f, PVB_IO, "another process is writing it; wait for it or choose another name");
  return -1;
}

// Locks the file with the final name, if there is one, so that no other process resumes it
// meanwhile.
static int pvbi_hold_replaced(pvb_file* f) {
  struct stat held, named;
  if (stat(f->path, &named) != 0) return errno == ENOENT ? 0 : pvbi_fail_io(f, "create");
  if (!S_ISREG(named.st_mode)) {
    return pvbi_fail(f, PVB_IO, "cannot create: not the name of a regular file; choose another");
  }
  if (f->replaced >= 0) {
    if (fstat(f->replaced, &held) == 0 && pvbi_same_file(&held, &named)) return 0;
    close(f->replaced);
  }
  f->replaced = pvbi_open_locked(f, f->path, O_RDONLY);
  return f->code;
}

// Renames NAME.partial to NAME.
static int pvbi_publish(pvb_file* f) {
  char* slash;
  int folder, result;
  if (pvbi_hold_replaced(f) != 0) return f->code;
  if (rename(f->partial, f->path) != 0) return pvbi_fail_io(f, "create");
  if (f->replaced >= 0) close(f->replaced);
  f->replaced = -1;
  slash = strrchr(f->partial, '/');  // its memory now holds the folder
  if (slash == PVBI_NULL) {
    memcpy(f->partial, ".", 2);
  } else {
    slash[slash == f->partial] = 0;
  }
  folder = f->no_sync ? -1 : open(f->partial, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // Some network file systems cannot sync a folder; the file itself is safe.
  result = folder < 0 || fsync(folder) == 0 || errno == EINVAL;
  if (!result) pvbi_fail_io(f, "sync the folder");
  if (folder >= 0) close(folder);
  free(f->partial);
  f->partial = PVBI_NULL;
  return f->code;
}

// ---- Frames

// Writes the prefix of the frame at `frame`, whose directory of `size` bytes already follows it.
static void pvbi_put_prefix(const pvb_file* f, unsigned char* frame, uint32_t type, uint32_t flags,
                            uint64_t length, uint32_t size) {
  memcpy(frame, pvbi_magic, 8);
  memcpy(frame + 8, f->uuid, 16);
  pvbi_put32(frame + 24, type);
  pvbi_put32(frame + 28, flags);
  pvbi_put64(frame + 32, f->end);
  pvbi_put64(frame + 40, length);
  pvbi_put64(frame + 48, f->sequence);
  pvbi_put32(frame + 56, size);
  pvbi_put32(frame + 60, pvbi_crc(f, pvbi_crc(f, 0, frame, 60), frame + PVBI_PREFIX, size));
}

static int pvbi_write_frame(pvb_file* f, const unsigned char* frame, size_t length) {
  if (f->end > INT64_MAX - length) return pvbi_fail(f, PVB_LIMIT, "more than 2^63 bytes");
  if (pvbi_pwrite(f, f->end, frame, length) != 0) return f->code;
  f->end += length;
  ++f->sequence;
  return 0;
}

// Returns 1 where there is a valid frame at `offset`, 0 where there is none, -1 on an error. At
// offset 0 it takes over the uuid.
static int pvbi_read_frame(pvb_file* f, uint64_t offset, pvbi_frame* out) {
  unsigned char prefix[PVBI_PREFIX], *directory;
  if (offset >= f->size || f->size - offset < PVBI_PREFIX) return 0;
  if (pvbi_pread(f, offset, prefix, sizeof prefix) != 0) return -1;
  if (memcmp(prefix, pvbi_magic, 8) != 0) return 0;
  if (offset == 0) memcpy(f->uuid, prefix + 8, 16);
  out->type = pvbi_get32(prefix + 24);
  out->flags = pvbi_get32(prefix + 28);
  out->offset = pvbi_get64(prefix + 32);
  out->length = pvbi_get64(prefix + 40);
  out->sequence = pvbi_get64(prefix + 48);
  out->size = pvbi_get32(prefix + 56);
  if (memcmp(prefix + 8, f->uuid, 16) != 0 || out->offset != offset ||
      out->length % PVBI_PAGE != 0 || out->length < PVBI_PREFIX || out->length > f->size - offset ||
      out->size > PVBI_MAX_DIRECTORY || out->size > out->length - PVBI_PREFIX) {
    return 0;
  }
  directory = pvbi_scratch(f, out->size);
  if (directory == PVBI_NULL) {
    pvbi_fail_memory(f);
    return -1;
  }
  if (pvbi_pread(f, offset + PVBI_PREFIX, directory, out->size) != 0) return -1;
  out->directory = directory;
  return pvbi_crc(f, pvbi_crc(f, 0, prefix, 60), directory, out->size) == pvbi_get32(prefix + 60);
}

static int pvbi_is_known(uint32_t type) {
  return type == PVBI_TYPE_HEAD || type == PVBI_TYPE_SLOT || type == PVBI_TYPE_CHNK ||
         type == PVBI_TYPE_CMIT;
}

// Finds the valid frame at *offset, or the first on a page behind it, and returns 1; *offset
// becomes the frame's end. Returns 0 at the end of the file, -1 on an error.
static int pvbi_next_frame(pvb_file* f, uint64_t* offset, pvbi_frame* out) {
  for (; *offset < f->size; *offset += PVBI_PAGE) {
    const int valid = pvbi_read_frame(f, *offset, out);
    if (valid < 0) return -1;
    if (!valid) continue;
    if ((out->flags & 1) != 0 && !pvbi_is_known(out->type)) {
      pvbi_fail(f, PVB_BAD_INPUT,
                "written by a later version of the format, with a frame at byte %llu that must be "
                "understood to read it; use a newer pvb.h",
                0ull + *offset);
      return -1;
    }
    *offset += out->length;
    return 1;
  }
  return 0;
}

static pvbi_section pvbi_get_section(const unsigned char* from) {
  pvbi_section section;
  section.offset = pvbi_get64(from);
  section.length = pvbi_get64(from + 8);
  section.crc = pvbi_get32(from + 16);
  return section;
}

static int pvbi_section_fits(const pvbi_frame* frame, const pvbi_section* section) {
  return section->offset >= PVBI_PREFIX + frame->size && section->offset % PVBI_ALIGN == 0 &&
         section->offset <= frame->length && section->length <= frame->length - section->offset;
}

// Whether the frame is a valid commit.
static int pvbi_decode_commit(const pvbi_frame* frame, pvbi_commit* out) {
  const unsigned char* d = frame->directory;
  pvbi_section head;
  if (frame->type != PVBI_TYPE_CMIT || frame->size < PVBI_COMMIT) return 0;
  out->offset = frame->offset;
  out->length = frame->length;
  out->sequence = frame->sequence;
  out->flags = pvbi_get32(d);
  out->number = pvbi_get64(d + 8);
  out->records = pvbi_get64(d + 16);
  out->chunks = pvbi_get64(d + 24);
  out->passes = pvbi_get64(d + 32);
  out->base = pvbi_get64(d + 48);
  out->first_chunk = pvbi_get64(d + 56);
  out->foreign = pvbi_get64(d + 64);
  out->index = pvbi_get_section(d + 72);
  head = pvbi_get_section(d + 96);
  out->state = pvbi_get_section(d + 120);
  return pvbi_section_fits(frame, &out->index) && pvbi_section_fits(frame, &head) &&
         pvbi_section_fits(frame, &out->state) && out->state.length <= PVBI_MAX_STATE &&
         out->number > 0 && out->first_chunk <= out->chunks &&
         out->chunks <= frame->offset / PVBI_PAGE &&  // each takes a page at least
         out->index.length % PVBI_ENTRY == 0 &&
         out->index.length / PVBI_ENTRY == out->chunks - out->first_chunk &&
         (out->first_chunk == 0 || out->base > 0) && out->base < frame->offset &&
         pvbi_get64(d + 40) < frame->offset;
}

// Returns 1, 0 or -1 like pvbi_read_frame.
static int pvbi_commit_at(pvb_file* f, uint64_t offset, pvbi_commit* out) {
  pvbi_frame frame;
  const int valid = pvbi_read_frame(f, offset, &frame);
  return valid == 1 ? pvbi_decode_commit(&frame, out) : valid;
}

// Reads a section into the scratch memory. Returns 1, 0 where its checksum is wrong, -1 on an
// error.
static int pvbi_read_section(pvb_file* f, const pvbi_commit* commit, const pvbi_section* section) {
  const size_t length = section->length & SIZE_MAX;
  unsigned char* bytes = pvbi_scratch(f, section->length);
  if (bytes == PVBI_NULL) {
    pvbi_fail_memory(f);
    return -1;
  }
  if (pvbi_pread(f, commit->offset + section->offset, bytes, length) != 0) return -1;
  return pvbi_crc(f, 0, bytes, length) == section->crc;
}

// ---- Head

static size_t pvbi_type_size(int type) {
  static const unsigned char sizes[8] = {0, 1, 2, 4, 8, 2, 4, 8};
  return type >= PVB_U8 && type <= PVB_F64 ? sizes[type] : 0;
}

// Copies one channel and checks it against those before.
static int pvbi_add_channel(pvb_file* f, const pvb_channel* given) {
  const size_t k = f->info.channel_count;
  const size_t length = given->name == PVBI_NULL ? 0 : strlen(given->name);
  const size_t size = pvbi_type_size(given->type);
  size_t i;
  if (k == PVBI_MAX_CHANNELS) return pvbi_fail(f, PVB_LIMIT, "more than 256 channels");
  if (length < 1 || length > PVBI_NAME) {
    return pvbi_fail(f, PVB_BAD_INPUT, "the name of channel %u must have 1 to 56 characters",
                     PVBI_CAST(unsigned, k));
  }
  for (i = 0; i < length; ++i) {
    if (given->name[i] < 0x21 || given->name[i] > 0x7E) {
      return pvbi_fail(f, PVB_BAD_INPUT, "the name of channel %u is not printable ASCII",
                       PVBI_CAST(unsigned, k));
    }
  }
  for (i = 0; i < k; ++i) {
    if (strcmp(given->name, f->names[i]) == 0) {
      return pvbi_fail(f, PVB_BAD_INPUT, "channel %s is declared twice", given->name);
    }
  }
  if (size == 0 || given->components < 1 || given->components > PVBI_MAX_COMPONENTS) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "channel %s: type %d with %d components; types are 1 to 7, "
                     "components 1 to 16",
                     given->name, given->type, given->components);
  }
  if (given->encoding != PVB_PLAIN &&
      (given->encoding != PVB_OCTAHEDRAL || given->type != PVB_U16 || given->components != 2)) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "channel %s: its encoding must be plain, or octahedral with "
                     "u16 x 2",
                     given->name);
  }
  memcpy(f->names[k], given->name, length + 1);
  f->channels[k] = *given;
  f->channels[k].name = f->names[k];
  f->bytes[k] = size * PVBI_CAST(unsigned, given->components);
  f->info.channels = f->channels;
  f->info.channel_count = k + 1;
  return 0;
}

static int pvbi_check_capacity(pvb_file* f) {
  uint64_t bytes = 0;
  size_t k;
  for (k = 0; k < f->info.channel_count; ++k) bytes += f->bytes[k];
  if (f->info.chunk_capacity < 1 || f->info.chunk_capacity > PVBI_MAX_RECORDS ||
      f->info.chunk_capacity * bytes > PVBI_MAX_CHUNK) {
    return pvbi_fail(f, PVB_LIMIT,
                     "chunks of %u records of %llu bytes; a chunk has 1 to 2^24 "
                     "records and at most 1 GiB",
                     f->info.chunk_capacity, 0ull + bytes);
  }
  return 0;
}

static int pvbi_set_metadata(pvb_file* f, const void* text, size_t size) {
  f->metadata = PVBI_CAST(char*, malloc(size + 1));
  if (f->metadata == PVBI_NULL) return pvbi_fail_memory(f);
  memcpy(f->metadata, text, size);
  f->metadata[size] = 0;
  f->info.metadata = f->metadata;
  f->info.metadata_size = size;
  return 0;
}

// Checks the declarations of a producer.
static int pvbi_declare(pvb_file* f, const pvb_channel* channels, size_t count,
                        const char* metadata) {
  const char *first = metadata, *last;
  size_t k;
  if (channels == PVBI_NULL || count == 0) return pvbi_fail(f, PVB_USAGE, "no channels are given");
  for (k = 0; k < count; ++k) {
    if (pvbi_add_channel(f, &channels[k]) != 0) return f->code;
  }
  if (metadata == PVBI_NULL) return pvbi_fail(f, PVB_USAGE, "no metadata is given; {} will do");
  if (strlen(metadata) > PVBI_MAX_METADATA) {
    return pvbi_fail(f, PVB_LIMIT, "more than 1 MiB of metadata");
  }
  last = metadata + strlen(metadata);
  while (*first != 0 && strchr(" \t\r\n", *first) != PVBI_NULL) ++first;
  while (last > first && strchr(" \t\r\n", last[-1]) != PVBI_NULL) --last;
  if (last - first < 2 || *first != '{' || last[-1] != '}') {
    return pvbi_fail(f, PVB_BAD_INPUT, "the metadata is no JSON object");
  }
  return pvbi_set_metadata(f, metadata, strlen(metadata));
}

static int pvbi_decode_head(pvb_file* f, const unsigned char* d, size_t size) {
  const size_t count = size < PVBI_HEAD ? 0 : pvbi_get32(d + 16);
  const size_t text = size < PVBI_HEAD ? 0 : pvbi_get32(d + 20);
  size_t k, i;
  if (size >= 8 && ((d[0] | d[1] << 8) != 1 || pvbi_get32(d + 4) != 0)) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "written by version %d.%d of the format; this program reads "
                     "version 1: use a newer one",
                     d[0] | d[1] << 8, d[2] | d[3] << 8);
  }
  if (count < 1 || count > PVBI_MAX_CHANNELS || text > PVBI_MAX_METADATA ||
      size < PVBI_HEAD + PVBI_CHANNEL * count + text) {
    return pvbi_fail(f, PVB_BAD_INPUT, "HEAD: impossible number of channels or length of metadata");
  }
  for (k = 0; k < count; ++k) {
    const unsigned char* entry = d + PVBI_HEAD + PVBI_CHANNEL * k;
    char name[PVBI_NAME + 1] = {0};
    pvb_channel channel;
    memcpy(name, entry, PVBI_NAME);
    for (i = strlen(name); i < PVBI_NAME; ++i) {
      if (name[i] != 0) {
        return pvbi_fail(f, PVB_BAD_INPUT, "HEAD: a channel's name is not padded with zeros");
      }
    }
    channel.name = name;
    channel.type = entry[56];
    channel.components = entry[57];
    channel.encoding = entry[58];
    if (pvbi_add_channel(f, &channel) != 0) return f->code;
  }
  f->info.chunk_capacity = pvbi_get32(d + 12);
  if (pvbi_check_capacity(f) != 0) return f->code;
  return pvbi_set_metadata(f, d + PVBI_HEAD + PVBI_CHANNEL * count, text);
}

static int pvbi_read_head(pvb_file* f) {
  unsigned char magic[8] = {0};
  pvbi_frame frame;
  int valid;
  if (f->size >= 8 && pvbi_pread(f, 0, magic, 8) != 0) return f->code;
  if (memcmp(magic, pvbi_magic, 8) != 0) {
    return pvbi_fail(f, PVB_BAD_INPUT, "is no path-vertex buffer; give the name of a .pvb file");
  }
  valid = pvbi_read_frame(f, 0, &frame);
  if (valid < 0) return f->code;
  if (!valid || frame.type != PVBI_TYPE_HEAD || frame.sequence != 0) {
    return pvbi_fail(f, PVB_BAD_INPUT, "its header cannot be read; 'psf recover' may restore it");
  }
  f->slot = frame.length;
  f->head_size = PVBI_PREFIX + frame.size;
  f->head = PVBI_CAST(unsigned char*, malloc(f->head_size));
  if (f->head == PVBI_NULL) return pvbi_fail_memory(f);
  memcpy(f->head + PVBI_PREFIX, frame.directory, frame.size);
  if (pvbi_pread(f, 0, f->head, PVBI_PREFIX) != 0) return f->code;
  return pvbi_decode_head(f, f->head + PVBI_PREFIX, frame.size);
}

// ---- Opening: README.md, "Opening"

// Finds the last valid commit. Returns PVB_BAD_INPUT where there is none, or the slot names a later
// one.
static int pvbi_find_last(pvb_file* f, pvbi_commit* last) {
  uint64_t offset = f->slot, hint[2][3] = {{0, 0, 0}, {0, 0, 0}};  // offset, length, sequence
  uint64_t promised = 0, promised_at = 0;
  pvbi_commit commit;
  pvbi_frame frame;
  int k, valid = pvbi_read_frame(f, f->slot, &frame), found = 0;
  if (valid == 1 && frame.type == PVBI_TYPE_SLOT) {
    for (k = 0; k < 2; ++k) {
      unsigned char r[PVBI_SLOT_RECORD];
      if (pvbi_pread(f, f->slot + (k == 0 ? 1024 : 2048), r, sizeof r) != 0) return f->code;
      if (pvbi_crc(f, 0, r, 28) != pvbi_get32(r + 28)) continue;
      hint[k][0] = pvbi_get64(r);
      hint[k][1] = pvbi_get64(r + 8);
      hint[k][2] = pvbi_get64(r + 16);
    }
  }
  for (k = 0; k < 2 && valid >= 0 && !found; ++k) {  // the higher sequence number first
    const uint64_t* h = hint[(hint[1][2] > hint[0][2]) != (k == 1)];
    if (h[2] == 0 || h[0] > f->size || h[1] > f->size - h[0]) continue;  // cut off: no promise
    valid = pvbi_commit_at(f, h[0], last);
    found = valid == 1 && last->sequence == h[2];
    if (!found && h[2] > promised) {
      promised = h[2];
      promised_at = h[0];
    }
  }
  if (found) offset = last->offset + last->length;
  while (valid >= 0 && (valid = pvbi_next_frame(f, &offset, &frame)) == 1) {
    if (pvbi_decode_commit(&frame, &commit)) {
      *last = commit;
      found = 1;
    }
  }
  if (valid < 0) return f->code;
  if (promised > 0 && (!found || last->sequence < promised)) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "damaged: the commit at byte %llu is unreadable, so records "
                     "are lost; 'psf recover' saves the rest",
                     0ull + promised_at);
  }
  if (!found) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "holds no committed pass: its writer was stopped before the "
                     "first; render again");
  }
  if (last->foreign > 0) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "written by a later version of the format, with frames that "
                     "must be understood to read it; use a newer pvb.h");
  }
  return 0;
}

static int pvbi_reserve_index(pvb_file* f, uint64_t count) {
  uint64_t room = f->index_room < 64 ? 64 : f->index_room;
  pvbi_entry* grown;
  if (count <= f->index_room) return 0;
  while (room < count) room *= 2;
  if (room > SIZE_MAX / sizeof *grown) return pvbi_fail_memory(f);
  grown = PVBI_CAST(pvbi_entry*, realloc(f->index, (room & SIZE_MAX) * sizeof *grown));
  if (grown == PVBI_NULL) return pvbi_fail_memory(f);
  f->index = grown;
  f->index_room = room & SIZE_MAX;
  return 0;
}

static pvbi_entry pvbi_get_entry(const unsigned char* from) {
  pvbi_entry entry;
  entry.offset = pvbi_get64(from);
  entry.length = pvbi_get64(from + 8);
  entry.first = pvbi_get64(from + 16);
  entry.count = pvbi_get32(from + 24);
  entry.pass = pvbi_get32(from + 28);
  return entry;
}

// Whether the index has every record up to the commit, in order.
static int pvbi_is_complete(const pvb_file* f, const pvbi_commit* last) {
  uint64_t record = 0, place = f->slot, passes = 0;
  size_t k;
  for (k = 0; k < f->chunks; ++k) {
    const pvbi_entry* e = &f->index[k];
    if (e->first != record || e->count < 1 || e->count > f->info.chunk_capacity ||
        e->offset < place || e->offset % PVBI_PAGE != 0 || e->offset > last->offset ||
        e->length > last->offset - e->offset || e->length < PVBI_PAGE ||
        (e->pass != passes && e->pass + 1ull != passes)) {
      return 0;
    }
    record += e->count;
    place = e->offset + e->length;
    passes = e->pass + 1ull;
  }
  return record == last->records && f->chunks == last->chunks && passes == last->passes;
}

// Reads the index from the last commit and its bases. Returns 1, 0 where one of them cannot be
// read, -1 on an error.
static int pvbi_load_index(pvb_file* f, const pvbi_commit* last) {
  pvbi_commit at = *last;
  if (pvbi_reserve_index(f, last->chunks) != 0) return -1;
  for (;;) {
    const int valid = pvbi_read_section(f, &at, &at.index);
    pvbi_commit base;
    uint64_t k;
    if (valid != 1) return valid;
    for (k = at.first_chunk; k < at.chunks; ++k) {
      f->index[k] = pvbi_get_entry(f->scratch + (k - at.first_chunk) * PVBI_ENTRY);
    }
    if (at.first_chunk == 0) break;
    k = at.first_chunk;
    if (pvbi_commit_at(f, at.base, &base) != 1) return f->code != 0 ? -1 : 0;
    if (base.chunks != k) return 0;
    at = base;
  }
  f->leap.offset = at.offset;
  f->leap.chunks = at.chunks;
  f->chunks = last->chunks & SIZE_MAX;
  return pvbi_is_complete(f, last);
}

static int pvbi_compare_entries(const void* a, const void* b) {
  const pvbi_entry *x = PVBI_CAST(const pvbi_entry*, a), *y = PVBI_CAST(const pvbi_entry*, b);
  if (x->first != y->first) return x->first < y->first ? -1 : 1;
  return x->offset < y->offset ? -1 : x->offset > y->offset;
}

static int pvbi_push(pvb_file* f, const pvbi_entry* entry) {
  if (pvbi_reserve_index(f, f->chunks + 1ull) != 0) return f->code;
  f->index[f->chunks++] = *entry;
  return 0;
}

// Rebuilds the index from every chunk and every index that can be read, where the chain of commits
// is broken.
static int pvbi_scan_index(pvb_file* f, const pvbi_commit* last) {
  uint64_t offset = f->slot, next = 0;
  size_t found, k;
  pvbi_frame frame;
  pvbi_commit commit;
  pvbi_entry entry;
  int valid;
  f->chunks = 0;
  while ((valid = pvbi_next_frame(f, &offset, &frame)) == 1) {
    if (frame.type == PVBI_TYPE_CHNK && frame.size >= PVBI_CHUNK) {
      entry.offset = frame.offset;
      entry.length = frame.length;
      entry.first = pvbi_get64(frame.directory);
      entry.count = pvbi_get32(frame.directory + 8);
      entry.pass = pvbi_get32(frame.directory + 12);
      if (pvbi_push(f, &entry) != 0) return f->code;
    } else if (pvbi_decode_commit(&frame, &commit)) {
      valid = pvbi_read_section(f, &commit, &commit.index);
      if (valid < 0) return f->code;
      for (k = 0; valid == 1 && k < commit.index.length / PVBI_ENTRY; ++k) {
        entry = pvbi_get_entry(f->scratch + k * PVBI_ENTRY);
        if (pvbi_push(f, &entry) != 0) return f->code;
      }
    }
  }
  if (valid < 0) return f->code;
  found = f->chunks;
  f->chunks = 0;
  if (found > 0) qsort(f->index, found, sizeof *f->index, pvbi_compare_entries);
  for (k = 0; k < found && f->index[k].first < last->records; ++k) {
    if (f->index[k].first < next) continue;  // another index told it already
    if (f->index[k].first > next) break;
    next += f->index[k].count;
    f->index[f->chunks++] = f->index[k];
  }
  f->leap.offset = f->leap.chunks = 0;
  if (pvbi_is_complete(f, last)) return 0;
  return pvbi_fail(f, PVB_BAD_INPUT,
                   "damaged: the chunk with record %llu cannot be found; "
                   "'psf verify' names every fault",
                   0ull + next);
}

// Reads everything that a reader and a resumed writer need. `f->fd` is open.
static int pvbi_load(pvb_file* f) {
  struct stat status;
  pvbi_commit last;
  int valid;
  if (fstat(f->fd, &status) != 0) return pvbi_fail_io(f, "read");
  if (!S_ISREG(status.st_mode)) {
    return pvbi_fail(f, PVB_IO, "is not a regular file; give the name of a .pvb file");
  }
  f->size = PVBI_CAST(uint64_t, status.st_size);
  if (pvbi_read_head(f) != 0 || pvbi_find_last(f, &last) != 0) return f->code;
  valid = pvbi_load_index(f, &last);
  if (valid == 0) pvbi_scan_index(f, &last);
  if (f->code != 0) return f->code;
  valid = pvbi_read_section(f, &last, &last.state);
  if (valid < 0) return f->code;
  if (valid == 1) {
    f->state = PVBI_CAST(unsigned char*, malloc(PVBI_MAX_STATE));
    if (f->state == PVBI_NULL) return pvbi_fail_memory(f);
    f->info.state_size = last.state.length & SIZE_MAX;
    memcpy(f->state, f->scratch, f->info.state_size);
    f->info.state = f->state;
  }
  f->end = f->committed_end = last.offset + last.length;
  f->sequence = last.sequence + 1;
  f->commits = last.number;
  f->previous.offset = last.offset;
  f->previous.chunks = last.chunks;
  f->appended = f->info.records = last.records;
  f->info.passes = last.passes;
  f->info.closed = (last.flags & 1) != 0;
  f->info.uncommitted = f->size - f->end;
  return 0;
}

// ---- Every file

static pvb_file* pvbi_new(const char* path) {
  pvb_file* f = PVBI_CAST(pvb_file*, calloc(1, sizeof *f));
  const size_t length = path == PVBI_NULL ? 0 : strlen(path);
  if (f == PVBI_NULL) return PVBI_NULL;
  f->fd = f->replaced = -1;
  f->path = PVBI_CAST(char*, calloc(1, length + 1));
  if (f->path == PVBI_NULL) {
    free(f);
    return PVBI_NULL;
  }
  if (length > 0) memcpy(f->path, path, length);
  pvbi_make_crc(f);
  if (length == 0) pvbi_fail(f, PVB_USAGE, "no file is named");
  return f;
}

// Every call in `mode` starts here. An error in reading affects its own call; any other error
// stays.
static int pvbi_enter(pvb_file* f, int mode) {
  if (f == PVBI_NULL) return PVB_LIMIT;
  if (f->mode == PVBI_READING && mode == PVBI_READING) f->code = 0;
  if (f->code != 0) return f->code;
  if (f->mode == mode) return 0;
  return pvbi_fail(f, PVB_USAGE,
                   f->mode == PVBI_DONE   ? "is closed already"
                   : mode == PVBI_READING ? "is open for writing only"
                                          : "is open for reading only");
}

const pvb_info* pvb_about(const pvb_file* file) {
  static const pvb_info nothing = {0, 0, 0, 0, PVBI_NULL, 0, PVBI_NULL, 0, PVBI_NULL, 0, 0};
  return file == PVBI_NULL || file->mode == PVBI_IDLE ? &nothing : &file->info;
}

const char* pvb_error(const pvb_file* file) {
  if (file == PVBI_NULL) return "out of memory";
  return file->code != 0 ? file->error : PVBI_NULL;
}

void pvb_free(pvb_file* file) {
  size_t k;
  if (file == PVBI_NULL) return;
  if (file->mode == PVBI_WRITING && file->partial != PVBI_NULL) {
    (void)unlink(file->partial);
  } else if (file->mode == PVBI_WRITING && file->commits > 0) {
    // Cuts off the uncommitted tail. A failure does no harm, since readers ignore such a tail.
    if (ftruncate(file->fd, PVBI_CAST(off_t, file->committed_end)) != 0) errno = 0;
  }
  if (file->fd >= 0) close(file->fd);
  if (file->replaced >= 0) close(file->replaced);
  for (k = 0; k < PVBI_MAX_CHANNELS; ++k) free(file->column[k]);
  free(file->pass_first);
  free(file->scratch);
  free(file->chunk);
  free(file->index);
  free(file->state);
  free(file->metadata);
  free(file->head);
  free(file->partial);
  free(file->path);
  free(file);
}

// ---- Writing

// Allocates the memory of a full chunk and places every column.
static int pvbi_prepare_chunk(pvb_file* f) {
  uint64_t place =
      pvbi_up(PVBI_PREFIX + PVBI_CHUNK + PVBI_COLUMN * f->info.channel_count, PVBI_ALIGN);
  size_t k;
  for (k = 0; k < f->info.channel_count; ++k) {
    f->place[k] = place & SIZE_MAX;
    place = pvbi_up(place + f->bytes[k] * f->info.chunk_capacity, PVBI_ALIGN);
  }
  f->chunk = PVBI_CAST(unsigned char*, malloc(pvbi_up(place, PVBI_PAGE) & SIZE_MAX));
  if (f->chunk == PVBI_NULL) return pvbi_fail_memory(f);
  if (f->state == PVBI_NULL) f->state = PVBI_CAST(unsigned char*, malloc(PVBI_MAX_STATE));
  f->info.state = f->state;
  return f->state == PVBI_NULL ? pvbi_fail_memory(f) : 0;
}

// Writes the slot record of a commit to `to`.
static void pvbi_put_slot_record(const pvb_file* f, unsigned char* to, uint64_t offset,
                                 uint64_t length, uint64_t sequence) {
  pvbi_put64(to, offset);
  pvbi_put64(to + 8, length);
  pvbi_put64(to + 16, sequence);
  pvbi_put32(to + 24, 0);
  pvbi_put32(to + 28, pvbi_crc(f, 0, to, 28));
}

// Writes HEAD and an empty SLOT.
static int pvbi_write_start(pvb_file* f) {
  const uint32_t size =
      (PVBI_HEAD + PVBI_CHANNEL * f->info.channel_count + f->info.metadata_size) & 0xFFFFFFFFu;
  const size_t length = pvbi_up(PVBI_PREFIX + size, PVBI_PAGE) & SIZE_MAX;
  unsigned char page[PVBI_PAGE] = {0}, *d;
  size_t k;
  f->head_size = PVBI_PREFIX + size;
  f->head = PVBI_CAST(unsigned char*, calloc(1, length));
  if (f->head == PVBI_NULL) return pvbi_fail_memory(f);
  d = f->head + PVBI_PREFIX;
  d[0] = 1;  // version 1.0
  pvbi_put32(d + 12, f->info.chunk_capacity);
  pvbi_put32(d + 16, f->info.channel_count & 0xFFFFFFFFu);
  pvbi_put32(d + 20, f->info.metadata_size & 0xFFFFFFFFu);
  for (k = 0; k < f->info.channel_count; ++k) {
    unsigned char* entry = d + PVBI_HEAD + PVBI_CHANNEL * k;
    memcpy(entry, f->names[k], strlen(f->names[k]));
    entry[56] = PVBI_CAST(unsigned char, f->channels[k].type);
    entry[57] = PVBI_CAST(unsigned char, f->channels[k].components);
    entry[58] = PVBI_CAST(unsigned char, f->channels[k].encoding);
  }
  memcpy(d + PVBI_HEAD + PVBI_CHANNEL * f->info.channel_count, f->metadata, f->info.metadata_size);
  pvbi_put_prefix(f, f->head, PVBI_TYPE_HEAD, 1, length, size);
  if (pvbi_write_frame(f, f->head, length) != 0) return f->code;
  f->slot = f->end;
  pvbi_put_prefix(f, page, PVBI_TYPE_SLOT, 0, PVBI_PAGE, 0);
  return pvbi_write_frame(f, page, PVBI_PAGE);
}

static int pvbi_make_uuid(pvb_file* f, const pvb_options* options) {
  int fd;
  if (options != PVBI_NULL && options->uuid != PVBI_NULL) {
    memcpy(f->uuid, options->uuid, 16);
    return 0;
  }
  fd = open("/dev/urandom", O_RDONLY | O_CLOEXEC);
  if (fd < 0 || read(fd, f->uuid, 16) != 16) pvbi_fail_io(f, "read /dev/urandom");
  if (fd >= 0) close(fd);
  f->uuid[6] = (f->uuid[6] & 0x0F) | 0x40;
  f->uuid[8] = (f->uuid[8] & 0x3F) | 0x80;
  return f->code;
}

pvb_file* pvb_create(const char* path, const pvb_channel* channels, size_t channel_count,
                     const char* metadata, const pvb_options* options) {
  const char* slash;
  size_t kept;
  pvb_file* f = pvbi_new(path);
  if (f == PVBI_NULL || f->code != 0) return f;
  f->no_sync = options != PVBI_NULL && options->no_sync;
  f->info.chunk_capacity =
      options != PVBI_NULL && options->chunk_capacity != 0 ? options->chunk_capacity : 65536;
  // Where the name would be too long, its last part is cut to 255 bytes with ".partial".
  slash = strrchr(path, '/');
  kept = slash == PVBI_NULL ? 0 : PVBI_CAST(size_t, slash + 1 - path);
  kept += strlen(path + kept) > 247 ? 247 : strlen(path + kept);
  f->partial = PVBI_CAST(char*, malloc(kept + sizeof ".partial"));
  if (f->partial == PVBI_NULL) {
    pvbi_fail_memory(f);
    return f;
  }
  memcpy(f->partial, path, kept);
  memcpy(f->partial + kept, ".partial", sizeof ".partial");
  if (pvbi_declare(f, channels, channel_count, metadata) != 0 || pvbi_check_capacity(f) != 0 ||
      pvbi_make_uuid(f, options) != 0 || pvbi_prepare_chunk(f) != 0 || pvbi_hold_replaced(f) != 0) {
    return f;
  }
  f->fd = pvbi_open_locked(f, f->partial, O_RDWR | O_CREAT | O_NOFOLLOW);
  if (f->fd < 0) return f;
  f->mode = PVBI_WRITING;
  // The file is emptied only after it is locked.
  if (ftruncate(f->fd, 0) != 0) {
    pvbi_fail_io(f, "write");
  } else {
    pvbi_write_start(f);
  }
  return f;
}

// Refuses channels and metadata that are not those of the file.
static int pvbi_check_same(pvb_file* f, const pvb_channel* channels, size_t count,
                           const char* metadata) {
  size_t k;
  for (k = 0; k < count || k < f->info.channel_count; ++k) {
    const pvb_channel *a = &channels[k], *b = &f->channels[k];
    if (k < count && k < f->info.channel_count && a->name != PVBI_NULL &&
        strcmp(a->name, b->name) == 0 && a->type == b->type && a->components == b->components &&
        a->encoding == b->encoding) {
      continue;
    }
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "cannot be resumed: channel %u (%s) is not the same; write "
                     "another file",
                     PVBI_CAST(unsigned, k), k < f->info.channel_count ? b->name : "none");
  }
  if (metadata == PVBI_NULL || strlen(metadata) != f->info.metadata_size ||
      memcmp(metadata, f->metadata, f->info.metadata_size) != 0) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "cannot be resumed: its metadata is not the same; write "
                     "another file");
  }
  if (f->head[PVBI_PREFIX + 2] != 0 || f->head[PVBI_PREFIX + 3] != 0) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "cannot be resumed: written by a later version of the "
                     "format; use a newer pvb.h");
  }
  if (f->info.state == PVBI_NULL) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "cannot be resumed: the checksum of its resume state is "
                     "wrong; render again");
  }
  return 0;
}

// Cuts off what is not committed, and writes the slot's page anew with the last commit in both
// records, since the old records may name a commit that is cut off.
static int pvbi_cut_tail(pvb_file* f) {
  unsigned char page[PVBI_PAGE] = {0};
  const uint64_t end = f->end, sequence = f->sequence;
  if (ftruncate(f->fd, PVBI_CAST(off_t, end)) != 0) return pvbi_fail_io(f, "write");
  f->end = f->slot;
  f->sequence = 1;
  pvbi_put_prefix(f, page, PVBI_TYPE_SLOT, 0, PVBI_PAGE, 0);
  f->end = end;
  f->sequence = sequence;
  pvbi_put_slot_record(f, page + 1024, f->previous.offset, end - f->previous.offset, sequence - 1);
  memcpy(page + 2048, page + 1024, PVBI_SLOT_RECORD);
  return pvbi_pwrite(f, f->slot, page, PVBI_PAGE);
}

pvb_file* pvb_resume(const char* path, const pvb_channel* channels, size_t channel_count,
                     const char* metadata, const pvb_options* options) {
  pvb_file* f = pvbi_new(path);
  if (f == PVBI_NULL || f->code != 0) return f;
  f->no_sync = options != PVBI_NULL && options->no_sync;
  f->fd = pvbi_open_locked(f, path, O_RDWR);
  if (f->fd < 0 || pvbi_load(f) != 0 ||
      pvbi_check_same(f, channels, channel_count, metadata) != 0 || pvbi_prepare_chunk(f) != 0) {
    return f;
  }
  f->mode = PVBI_WRITING;
  pvbi_cut_tail(f);
  return f;
}

// Copies records. With a size known to the compiler, memcpy is an instruction or two.
static void pvbi_copy(unsigned char* to, size_t to_stride, const unsigned char* from,
                      size_t from_stride, size_t size, size_t count) {
  size_t k;
  if (to_stride == size && from_stride == size) {
    memcpy(to, from, size * count);
    return;
  }
#define PVBI_COPY(size) \
  for (k = 0; k < count; ++k) memcpy(to + k * to_stride, from + k * from_stride, size)
  if (size == 4) {
    PVBI_COPY(4);
  } else if (size == 12) {
    PVBI_COPY(12);
  } else {
    PVBI_COPY(size);
  }
}

// Writes the chunk being filled. Where it is not full, its columns move together.
static int pvbi_flush(pvb_file* f) {
  const size_t channels = f->info.channel_count;
  const uint32_t size = (PVBI_CHUNK + PVBI_COLUMN * channels) & 0xFFFFFFFFu;
  unsigned char* d = f->chunk + PVBI_PREFIX;
  size_t k, place = PVBI_PREFIX + size, length;
  pvbi_entry entry;
  if (f->filled == 0) return 0;
  if (f->info.passes >= UINT32_MAX) return pvbi_fail(f, PVB_LIMIT, "more than 2^32 - 1 passes");
  memset(d, 0, size);
  pvbi_put64(d, f->appended);
  pvbi_put32(d + 8, f->filled);
  pvbi_put32(d + 12, f->info.passes & 0xFFFFFFFFu);
  pvbi_put32(d + 16, channels & 0xFFFFFFFFu);
  for (k = 0; k < channels; ++k) {
    unsigned char* column = d + PVBI_CHUNK + PVBI_COLUMN * k;
    const size_t stored = f->bytes[k] * f->filled;
    const size_t start = pvbi_up(place, PVBI_ALIGN) & SIZE_MAX;
    memset(f->chunk + place, 0, start - place);
    if (start != f->place[k]) memmove(f->chunk + start, f->chunk + f->place[k], stored);
    pvbi_put32(column, k & 0xFFFFu);  // codec raw, no filter
    pvbi_put32(column + 4, pvbi_crc(f, 0, f->chunk + start, stored));
    pvbi_put64(column + 8, start);
    pvbi_put64(column + 16, stored);
    place = start + stored;
  }
  length = pvbi_up(place, PVBI_PAGE) & SIZE_MAX;
  memset(f->chunk + place, 0, length - place);
  pvbi_put_prefix(f, f->chunk, PVBI_TYPE_CHNK, 1, length, size);
  entry.offset = f->end;
  entry.length = length;
  entry.first = f->appended;
  entry.count = f->filled;
  entry.pass = f->info.passes & 0xFFFFFFFFu;
  if (pvbi_push(f, &entry) != 0 || pvbi_write_frame(f, f->chunk, length) != 0) return f->code;
  f->appended += f->filled;
  f->filled = 0;
  return 0;
}

int pvb_append(pvb_file* file, size_t count, const pvb_array* arrays) {
  size_t done = 0, k;
  if (pvbi_enter(file, PVBI_WRITING) != 0) return file == PVBI_NULL ? PVB_LIMIT : file->code;
  if (count > 0 && arrays == PVBI_NULL) return pvbi_fail(file, PVB_USAGE, "no arrays are given");
  for (k = 0; k < file->info.channel_count && count > 0; ++k) {
    if (arrays[k].data == PVBI_NULL) {
      return pvbi_fail(file, PVB_USAGE, "no values are given for channel %s", file->names[k]);
    }
  }
  if (count > INT64_MAX - file->appended - file->filled) {
    return pvbi_fail(file, PVB_LIMIT, "more than 2^63 records");
  }
  while (done < count) {
    // Copies few records at a time, so that the structs are still in the cache for their next
    // member.
    const size_t room = file->info.chunk_capacity - file->filled, most = room < 256 ? room : 256;
    const size_t taken = count - done < most ? count - done : most;
    for (k = 0; k < file->info.channel_count; ++k) {
      const size_t size = file->bytes[k], stride = arrays[k].stride;
      pvbi_copy(file->chunk + file->place[k] + size * file->filled, size,
                PVBI_CAST(const unsigned char*, arrays[k].data) + done * stride, stride, size,
                taken);
    }
    file->filled += taken & 0xFFFFFFFFu;
    done += taken;
    if (file->filled == file->info.chunk_capacity && pvbi_flush(file) != 0) return file->code;
  }
  return 0;
}

// Puts one section of a commit at its place; returns the place of the next.
static uint64_t pvbi_put_section(const pvb_file* f, unsigned char* frame, unsigned char* entry,
                                 uint64_t place, size_t length) {
  pvbi_put64(entry, place);
  pvbi_put64(entry + 8, length);
  pvbi_put32(entry + 16, pvbi_crc(f, 0, frame + place, length));
  return pvbi_up(place + length, PVBI_ALIGN);
}

// Builds the frame CMIT. The commit has the number f->commits + 1, and its index starts behind
// `base`.
static unsigned char* pvbi_make_commit(pvb_file* f, uint32_t flags, uint64_t passes,
                                       const pvbi_anchor* base, size_t* length) {
  const size_t index_size = (f->chunks - (base->chunks & SIZE_MAX)) * PVBI_ENTRY;
  const uint64_t index = pvbi_up(PVBI_PREFIX + PVBI_COMMIT, PVBI_ALIGN);
  const uint64_t head = pvbi_up(index + index_size, PVBI_ALIGN);
  const uint64_t state = pvbi_up(head + f->head_size, PVBI_ALIGN);
  unsigned char *frame, *d;
  size_t k;
  *length = pvbi_up(state + f->info.state_size, PVBI_PAGE) & SIZE_MAX;
  frame = PVBI_CAST(unsigned char*, calloc(1, *length));
  if (frame == PVBI_NULL) {
    pvbi_fail_memory(f);
    return PVBI_NULL;
  }
  d = frame + PVBI_PREFIX;
  pvbi_put32(d, flags);
  pvbi_put64(d + 8, f->commits + 1);
  pvbi_put64(d + 16, f->appended);
  pvbi_put64(d + 24, f->chunks);
  pvbi_put64(d + 32, passes);
  pvbi_put64(d + 40, f->previous.offset);
  pvbi_put64(d + 48, base->offset);
  pvbi_put64(d + 56, base->chunks);
  for (k = 0; k < index_size / PVBI_ENTRY; ++k) {
    const pvbi_entry* entry = &f->index[base->chunks + k];
    unsigned char* to = frame + index + k * PVBI_ENTRY;
    pvbi_put64(to, entry->offset);
    pvbi_put64(to + 8, entry->length);
    pvbi_put64(to + 16, entry->first);
    pvbi_put32(to + 24, entry->count);
    pvbi_put32(to + 28, entry->pass);
  }
  memcpy(frame + head, f->head, f->head_size);
  memcpy(frame + state, f->state, f->info.state_size);
  pvbi_put_section(f, frame, d + 72, index, index_size);
  pvbi_put_section(f, frame, d + 96, head, f->head_size);
  pvbi_put_section(f, frame, d + 120, state, f->info.state_size);
  pvbi_put_prefix(f, frame, PVBI_TYPE_CMIT, 1, *length, PVBI_COMMIT);
  return frame;
}

static int pvbi_write_commit(pvb_file* f, uint32_t flags, uint64_t passes) {
  static const pvbi_anchor none = {0, 0};
  const uint64_t number = f->commits + 1, offset = f->end;
  const pvbi_anchor* base = flags != 0 || number % PVBI_LEAP == 0 ? &none
                            : number % PVBI_STEP == 0             ? &f->leap
                                                                  : &f->previous;
  unsigned char slot[PVBI_SLOT_RECORD], *frame;
  size_t length;
  if (pvbi_sync(f) != 0) return f->code;
  frame = pvbi_make_commit(f, flags, passes, base, &length);
  if (frame == PVBI_NULL) return f->code;
  pvbi_put_slot_record(f, slot, offset, length, f->sequence);
  pvbi_write_frame(f, frame, length);
  free(frame);
  if (f->code != 0 || pvbi_sync(f) != 0 ||
      pvbi_pwrite(f, f->slot + (number % 2 == 1 ? 1024 : 2048), slot, sizeof slot) != 0 ||
      (f->partial != PVBI_NULL && pvbi_publish(f) != 0)) {
    return f->code;
  }
  f->commits = number;
  f->committed_end = f->end;
  f->previous.offset = offset;
  f->previous.chunks = f->chunks;
  if (base == &none) f->leap = f->previous;
  f->info.records = f->appended;
  f->info.passes = passes;
  f->info.closed = flags != 0;
  f->info.uncommitted = 0;
  return 0;
}

int pvb_commit(pvb_file* file, const void* state, size_t state_size) {
  if (pvbi_enter(file, PVBI_WRITING) != 0) return file == PVBI_NULL ? PVB_LIMIT : file->code;
  if (state_size > PVBI_MAX_STATE || (state == PVBI_NULL && state_size > 0)) {
    return pvbi_fail(file, PVB_LIMIT, "%llu bytes of resume state; at most 65536 fit",
                     0ull + state_size);
  }
  if (pvbi_flush(file) != 0) return file->code;
  if (file->appended == file->info.records) {
    return pvbi_fail(file, PVB_USAGE, "a pass without records cannot be committed");
  }
  if (state_size > 0) memmove(file->state, state, state_size);
  file->info.state_size = state_size;
  return pvbi_write_commit(file, 0, file->info.passes + 1);
}

int pvb_close(pvb_file* file) {
  int result;
  if (pvbi_enter(file, PVBI_WRITING) != 0) return file == PVBI_NULL ? PVB_LIMIT : file->code;
  if (file->filled > 0 || file->appended != file->info.records) {
    return pvbi_fail(file, PVB_USAGE, "records were appended but not committed");
  }
  if (file->commits == 0) return pvbi_fail(file, PVB_USAGE, "closed without a pass");
  // A resumed file to which nothing was added may be closed as it is.
  if (!file->info.closed && pvbi_write_commit(file, 1, file->info.passes) != 0) return file->code;
  file->mode = PVBI_DONE;
  result = close(file->fd);
  file->fd = -1;
  return result == 0 ? 0 : pvbi_fail_io(file, "write");
}

// ---- Reading

pvb_file* pvb_open(const char* path) {
  pvb_file* f = pvbi_new(path);
  size_t k;
  if (f == PVBI_NULL || f->code != 0) return f;
  // Without O_NONBLOCK, opening a named pipe would wait for a writer.
  f->fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (f->fd < 0) {
    pvbi_fail_io(f, "open");
    return f;
  }
  if (pvbi_load(f) != 0) return f;
  // No more passes than chunks: pvbi_is_complete has seen to it.
  f->pass_first = PVBI_CAST(uint64_t*, malloc((f->chunks + 1) * sizeof *f->pass_first));
  if (f->pass_first == PVBI_NULL) {
    pvbi_fail_memory(f);
    return f;
  }
  for (k = f->chunks; k-- > 0;) f->pass_first[f->index[k].pass] = f->index[k].first;
  f->pass_first[f->info.passes] = f->info.records;
  f->mode = PVBI_READING;
  return f;
}

int pvb_find(const pvb_file* file, const char* channel) {
  const pvb_info* info = pvb_about(file);
  int k;
  for (k = 0; k < PVBI_CAST(int, info->channel_count); ++k) {
    if (strcmp(info->channels[k].name, channel) == 0) return k;
  }
  return -1;
}

int pvb_pass(pvb_file* file, uint64_t pass, uint64_t* first, uint64_t* count) {
  if (pvbi_enter(file, PVBI_READING) != 0) return file == PVBI_NULL ? PVB_LIMIT : file->code;
  if (pass >= file->info.passes) {
    return pvbi_fail(file, PVB_USAGE, "has %llu passes; pass %llu is asked for",
                     0ull + file->info.passes, 0ull + pass);
  }
  *first = file->pass_first[pass];
  *count = file->pass_first[pass + 1] - *first;
  return 0;
}

// Reads a column of a chunk to f->column[channel]. Returns NULL, or the reason why it cannot.
static const char* pvbi_load_column(pvb_file* f, size_t chunk, size_t channel) {
  const pvbi_entry* e = &f->index[chunk];
  const size_t size = f->bytes[channel] * e->count;
  const unsigned char *d, *column;
  pvbi_frame frame;
  uint64_t offset;
  uint32_t crc, kind;
  const int valid = pvbi_read_frame(f, e->offset, &frame);
  if (valid < 0) return f->error;
  d = frame.directory;
  if (!valid || frame.type != PVBI_TYPE_CHNK || frame.length != e->length ||
      frame.size < PVBI_CHUNK + PVBI_COLUMN * f->info.channel_count || pvbi_get64(d) != e->first ||
      pvbi_get32(d + 8) != e->count || pvbi_get32(d + 12) != e->pass ||
      pvbi_get32(d + 16) != f->info.channel_count) {
    return "its frame cannot be read; 'psf verify' names every fault";
  }
  column = d + PVBI_CHUNK + PVBI_COLUMN * channel;
  kind = pvbi_get32(column);
  crc = pvbi_get32(column + 4);
  offset = pvbi_get64(column + 8);
  if ((kind & 0xFFFF) == channel && (kind >> 16 & 0xFF) == 1) {
    return "compressed with zstd, which pvb.h does not read; 'psf cat --codec raw' converts it";
  }
  if (kind != channel || pvbi_get64(column + 16) != size || offset < PVBI_PREFIX + frame.size ||
      offset % PVBI_ALIGN != 0 || offset > frame.length || size > frame.length - offset) {
    return "unknown codec, or impossible place or length; 'psf verify' names every fault";
  }
  f->column_chunk[channel] = 0;
  free(f->column[channel]);
  f->column[channel] = PVBI_CAST(unsigned char*, malloc(size));
  if (f->column[channel] == PVBI_NULL) return "out of memory";
  if (pvbi_pread(f, e->offset + offset, f->column[channel], size) != 0) return f->error;
  if (pvbi_crc(f, 0, f->column[channel], size) != crc) {
    return "its checksum is wrong; 'psf verify' names every fault";
  }
  f->column_chunk[channel] = chunk + 1;
  return PVBI_NULL;
}

int pvb_read(pvb_file* file, size_t channel, uint64_t first, size_t count, void* out,
             size_t stride) {
  unsigned char* to = PVBI_CAST(unsigned char*, out);
  size_t low = 0, high, chunk;
  if (pvbi_enter(file, PVBI_READING) != 0) return file == PVBI_NULL ? PVB_LIMIT : file->code;
  if (channel >= file->info.channel_count) {
    return pvbi_fail(file, PVB_USAGE, "has no channel %llu", 0ull + channel);
  }
  if (first > file->info.records || count > file->info.records - first) {
    return pvbi_fail(file, PVB_USAGE, "holds %llu records; %llu from %llu on are asked for",
                     0ull + file->info.records, 0ull + count, 0ull + first);
  }
  if (count > 0 && (out == PVBI_NULL || stride < file->bytes[channel])) {
    return pvbi_fail(file, PVB_USAGE, "channel %s has %u bytes a record; the stride is less",
                     file->names[channel], PVBI_CAST(unsigned, file->bytes[channel]));
  }
  for (high = file->chunks; high - low > 1;) {  // the chunk of `first` is in [low, high)
    const size_t middle = low + (high - low) / 2;
    *(file->index[middle].first <= first ? &low : &high) = middle;
  }
  for (chunk = low; count > 0; ++chunk) {
    const pvbi_entry* e = &file->index[chunk];
    const uint64_t skipped = first - e->first;
    const size_t left = (e->count - skipped) & SIZE_MAX, taken = left < count ? left : count;
    const size_t size = file->bytes[channel];
    if (file->column_chunk[channel] != chunk + 1) {
      const char* why = pvbi_load_column(file, chunk, channel);
      if (why == file->error) return file->code;
      if (why != PVBI_NULL) {
        return pvbi_fail(file, PVB_BAD_INPUT, "chunk %llu (records %llu-%llu), channel %s: %s",
                         0ull + chunk, 0ull + e->first, e->first + e->count - 1ull,
                         file->names[channel], why);
      }
    }
    pvbi_copy(to, stride, file->column[channel] + skipped * size, size, size, taken);
    to += taken * stride;
    first += taken;
    count -= taken;
  }
  return 0;
}

#endif  // PVB_IMPLEMENTATION
