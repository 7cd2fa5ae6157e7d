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
// Tables (version 1.1 of the format) are other records beside those of the paths, under the same
// passes, such as every vertex of every path. They are declared when the file is made:
//
//     const pvb_channel vertex[] = {PVB_PATH, PVB_PARENT, PVB_POSITION, PVB_THROUGHPUT,
//                                   PVB_EMISSION, PVB_DIRECT, PVB_BACKGROUND};
//     const pvb_table tables[] = {{"vertices", vertex, 7, 0}};
//     pvb_file *file = pvb_create_with("out.pvb", channels, 5, tables, 1, metadata, NULL);
//     ...
//       pvb_append_to(file, 0, count, vertex_arrays);  // as many as there are, before pvb_commit()
//
// README.md, "Tables", has the meaning of `vertices` and `photons`. A file without tables is one of
// version 1.0.
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
#define PVB_FRAME {"frame", PVB_U32, 1, PVB_PLAIN}                  // of a sequence, from 0
#define PVB_ALPHA {"alpha", PVB_F32, 1, PVB_PLAIN}                  // coverage: 0 background
#define PVB_KIND {"kind", PVB_U8, 1, PVB_PLAIN}                     // 0 surface 1 curve 2 volume
#define PVB_REST_POSITION {"rest_position", PVB_F32, 3, PVB_PLAIN}  // x_i at frame 0

// Of the tables `vertices` and `photons`, what is not among those above. README.md, "Tables", has
// the exact meaning of each there, and says which are required.
#define PVB_PATH {"path", PVB_U32, 1, PVB_PLAIN}                    // counted from 0 in the pass
#define PVB_PARENT {"parent", PVB_U32, 1, PVB_PLAIN}                // in records back; 0: camera
#define PVB_EMISSION {"emission", PVB_F32, 3, PVB_PLAIN}            // radiance toward the parent
#define PVB_DIRECT {"direct", PVB_F32, 3, PVB_PLAIN}                // radiance toward the parent
#define PVB_BACKGROUND {"background", PVB_F32, 3, PVB_PLAIN}        // radiance along `outgoing`
#define PVB_DEPTH {"depth", PVB_U16, 1, PVB_PLAIN}                  // vertices before, on the path
#define PVB_OUTGOING {"outgoing", PVB_F32, 3, PVB_PLAIN}            // unit, where the path goes on
#define PVB_PDF {"pdf", PVB_F32, 1, PVB_PLAIN}                      // of `outgoing`, a solid angle
#define PVB_LOBE {"lobe", PVB_U8, 1, PVB_PLAIN}                     // its values are below
#define PVB_POWER {"power", PVB_F32, 3, PVB_PLAIN}                  // flux, per light path
#define PVB_LIGHT {"light", PVB_U32, 1, PVB_PLAIN}                  // index in the metadata
// clang-format on

// Bits of the channel `flags`; of `flags` in the table `vertices`.
enum { PVB_HAS_VERTEX = 1, PVB_IS_SHADED = 2 };
enum { PVB_IS_X_I = 1 };

// Values of the channels `kind` and `lobe`; the last is added to a lobe that transmits.
enum { PVB_SURFACE = 0, PVB_CURVE = 1, PVB_VOLUME = 2 };
enum {
  PVB_LOBE_NONE = 0,
  PVB_LOBE_DIFFUSE = 1,
  PVB_LOBE_GLOSSY = 2,
  PVB_LOBE_SPECULAR = 3,
  PVB_LOBE_TRANSMITTED = 8
};

// A table: its name, and the channels of its records.
typedef struct pvb_table {
  const char* name;             // 1 to 56 characters '!' to '~', unique in the file, not "paths"
  const pvb_channel* channels;  // names are unique in the table
  size_t channel_count;         // 1 to 256
  uint32_t chunk_capacity;      // as in pvb_options
} pvb_table;

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

// What a file holds of a table.
typedef struct pvb_table_info {
  const char* name;             // as declared
  uint64_t records;             // committed
  uint32_t chunk_capacity;      // most records per chunk
  const pvb_channel* channels;  // in the order of the file
  size_t channel_count;         // number of channels
} pvb_table_info;

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
  const pvb_table_info* tables;  // in the order of the file; the rest is of the paths
  size_t table_count;            // number of tables
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

// Starts a file that has tables beside the paths, at most 16.
pvb_file* pvb_create_with(const char* path, const pvb_channel* channels, size_t channel_count,
                          const pvb_table* tables, size_t table_count, const char* metadata,
                          const pvb_options* options);

// Goes on with a file that has tables. Their names and channels must be the same, too.
pvb_file* pvb_resume_with(const char* path, const pvb_channel* channels, size_t channel_count,
                          const pvb_table* tables, size_t table_count, const char* metadata,
                          const pvb_options* options);

// Adds `count` records to the current pass; arrays[k] has the values of channel k. NaN and infinity
// are kept bit for bit.
int pvb_append(pvb_file* file, size_t count, const pvb_array* arrays);

// The same for a table, counted from 0 in the order of their declaration.
int pvb_append_to(pvb_file* file, size_t table, size_t count, const pvb_array* arrays);

// Ends the pass, which must have paths but may have no record of a table, and writes it to the
// disk. `state`: up to 64 KiB that a later pvb_resume() gives back; NULL and 0 for none.
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

// Index of a table in pvb_about()->tables, or -1.
int pvb_find_table(const pvb_file* file, const char* table);

// Index of a channel in the channels of a table, or -1.
int pvb_find_in(const pvb_file* file, size_t table, const char* channel);

// pvb_pass() for a table, whose records are counted from 0.
int pvb_pass_of(pvb_file* file, size_t table, uint64_t pass, uint64_t* first, uint64_t* count);

// pvb_read() for a table.
int pvb_read_from(pvb_file* file, size_t table, size_t channel, uint64_t first, size_t count,
                  void* out, size_t stride);

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
  PVBI_HAS_TABLES = 2,  // optional feature of HEAD: tables
  PVBI_TABLES = 8,      // what precedes the tables in HEAD and in CMIT
  PVBI_TABLE = 64,      // a table in HEAD, without its channels
  PVBI_TOTAL = 32,      // a table in CMIT
  PVBI_SLOT_RECORD = 32,
  PVBI_STEP = 64,  // which commits carry more of the index: README.md, "The index"
  PVBI_LEAP = 4096,
  PVBI_MAX_TABLES = 16,
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
#define PVBI_TYPE_TCHK PVBI_TYPE(0x54u, 0x43u, 0x48u, 0x4Bu)
#define PVBI_TYPE_CMIT PVBI_TYPE(0x43u, 0x4Du, 0x49u, 0x54u)

static const unsigned char pvbi_magic[8] = {0x89, 0x50, 0x56, 0x42, 0x0D, 0x0A, 0x1A, 0x01};

// The number in the file of a table of the caller's, counted from 0; one that cannot be stays so.
#define PVBI_TABLE_NUMBER(table) ((table) < PVBI_MAX_TABLES ? (table) + 1 : SIZE_MAX)

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

typedef struct pvbi_total {  // what a commit says of the paths, or of a table
  uint64_t records, chunks, first_chunk;
} pvbi_total;

typedef struct pvbi_commit {
  uint64_t offset, length, sequence;  // those of the frame
  uint64_t number, passes, base, foreign;
  pvbi_total total[1 + PVBI_MAX_TABLES];  // of the paths, then of each table
  uint32_t flags;
  pvbi_section index, state;
} pvbi_commit;

typedef struct pvbi_anchor {  // a commit that the index of a later one may build on
  uint64_t offset, chunks[1 + PVBI_MAX_TABLES];
} pvbi_anchor;

typedef struct pvbi_table {  // the paths, or a table
  size_t number;             // in the file; 0: the paths
  char name[PVBI_NAME + 1];
  char label[PVBI_NAME + 16];  // before texts on its channels and chunks; empty for the paths
  uint32_t capacity;
  size_t channel_count;
  pvb_channel channels[PVBI_MAX_CHANNELS];
  char names[PVBI_MAX_CHANNELS][PVBI_NAME + 1];
  size_t bytes[PVBI_MAX_CHANNELS];  // size of a record of each channel

  pvbi_entry* index;
  size_t chunks, index_room;
  uint64_t committed, appended;  // records; appended: in chunks that are written

  unsigned char* chunk;             // the frame being filled; columns have the places of a full one
  size_t place[PVBI_MAX_CHANNELS];  // place of each column in the frame
  uint32_t filled;                  // number of records in the frame

  unsigned char* column[PVBI_MAX_CHANNELS];  // the last column that was read of each channel ...
  size_t column_chunk[PVBI_MAX_CHANNELS];    // ... and its chunk + 1; 0: none
} pvbi_table;

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
  pvbi_table* table[1 + PVBI_MAX_TABLES];  // the paths, then the tables
  size_t tables;                           // number of these
  pvb_table_info table_info[PVBI_MAX_TABLES];
  char* metadata;
  unsigned char* state;

  uint64_t size;       // size of the file when it was opened; nothing is read behind it
  uint64_t slot, end;  // offsets of SLOT and of the next frame
  uint64_t sequence;   // sequence number of the next frame
  uint64_t committed_end, commits;
  pvbi_anchor previous, leap;

  unsigned char* scratch;
  size_t scratch_size;
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
         type == PVBI_TYPE_TCHK || type == PVBI_TYPE_CMIT;
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

// Takes what a commit says of the tables, whose indices follow in its directory. Returns 0 where it
// is not possible.
static int pvbi_decode_totals(const pvb_file* f, const pvbi_frame* frame, pvbi_commit* out) {
  const unsigned char* d = frame->directory + PVBI_COMMIT;
  const size_t size = frame->size - PVBI_COMMIT, tables = f->tables - 1;
  const uint64_t most = frame->offset / PVBI_PAGE;  // chunks: each takes a page at least
  uint64_t chunks = out->total[0].chunks, entries = 0;
  size_t t;
  for (t = 1; t <= tables; ++t) memset(&out->total[t], 0, sizeof out->total[t]);
  if (tables > 0 && size > 0) {  // else a program of version 1.0 has copied the paths alone
    if (size < PVBI_TABLES + PVBI_TOTAL * tables || pvbi_get32(d) != tables) return 0;
    for (t = 1; t <= tables; ++t) {
      const unsigned char* from = d + PVBI_TABLES + PVBI_TOTAL * (t - 1);
      out->total[t].records = pvbi_get64(from);
      out->total[t].chunks = pvbi_get64(from + 8);
      out->total[t].first_chunk = pvbi_get64(from + 16);
    }
  }
  if (chunks > most) return 0;
  for (t = 0; t <= tables; ++t) {
    const pvbi_total* total = &out->total[t];
    if (total->first_chunk > total->chunks || total->chunks > most) return 0;
    if (total->first_chunk > 0 && out->total[0].first_chunk == 0) return 0;  // there is no base
    if (t == 0) continue;
    chunks += total->chunks;
    entries += total->chunks - total->first_chunk;
  }
  return chunks <= most &&
         (entries == 0 || entries <= (size - PVBI_TABLES - PVBI_TOTAL * tables) / PVBI_ENTRY);
}

// Whether the frame is a valid commit.
static int pvbi_decode_commit(const pvb_file* f, const pvbi_frame* frame, pvbi_commit* out) {
  const unsigned char* d = frame->directory;
  pvbi_section head;
  if (frame->type != PVBI_TYPE_CMIT || frame->size < PVBI_COMMIT) return 0;
  out->offset = frame->offset;
  out->length = frame->length;
  out->sequence = frame->sequence;
  out->flags = pvbi_get32(d);
  out->number = pvbi_get64(d + 8);
  out->total[0].records = pvbi_get64(d + 16);
  out->total[0].chunks = pvbi_get64(d + 24);
  out->passes = pvbi_get64(d + 32);
  out->base = pvbi_get64(d + 48);
  out->total[0].first_chunk = pvbi_get64(d + 56);
  out->foreign = pvbi_get64(d + 64);
  out->index = pvbi_get_section(d + 72);
  head = pvbi_get_section(d + 96);
  out->state = pvbi_get_section(d + 120);
  return pvbi_decode_totals(f, frame, out) && pvbi_section_fits(frame, &out->index) &&
         pvbi_section_fits(frame, &head) && pvbi_section_fits(frame, &out->state) &&
         out->state.length <= PVBI_MAX_STATE && out->number > 0 &&
         out->index.length % PVBI_ENTRY == 0 &&
         out->index.length / PVBI_ENTRY == out->total[0].chunks - out->total[0].first_chunk &&
         (out->total[0].first_chunk == 0 || out->base > 0) && out->base < frame->offset &&
         pvbi_get64(d + 40) < frame->offset;
}

// Returns 1, 0 or -1 like pvbi_read_frame.
static int pvbi_commit_at(pvb_file* f, uint64_t offset, pvbi_commit* out) {
  pvbi_frame frame;
  const int valid = pvbi_read_frame(f, offset, &frame);
  return valid == 1 ? pvbi_decode_commit(f, &frame, out) : valid;
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

// Checks the name of a channel or a table: the one of this number in what `label` names.
static int pvbi_check_name(pvb_file* f, const char* label, const char* what, size_t number,
                           const char* name) {
  const size_t length = name == PVBI_NULL ? 0 : strlen(name);
  size_t i;
  if (length < 1 || length > PVBI_NAME) {
    return pvbi_fail(f, PVB_BAD_INPUT, "%sthe name of %s %u must have 1 to 56 characters", label,
                     what, PVBI_CAST(unsigned, number));
  }
  for (i = 0; i < length; ++i) {
    if (name[i] < 0x21 || name[i] > 0x7E) {
      return pvbi_fail(f, PVB_BAD_INPUT, "%sthe name of %s %u is not printable ASCII", label, what,
                       PVBI_CAST(unsigned, number));
    }
  }
  return 0;
}

// Adds the paths, whose name is "paths", and then the tables, without channels yet. Returns NULL
// and sets an error where it cannot.
static pvbi_table* pvbi_add_table(pvb_file* f, const char* name, uint32_t capacity) {
  pvbi_table* table;
  size_t t;
  if (f->tables > PVBI_MAX_TABLES) {
    pvbi_fail(f, PVB_LIMIT, "more than 16 tables");
    return PVBI_NULL;
  }
  if (f->tables > 0 && pvbi_check_name(f, "", "table", f->tables - 1, name) != 0) return PVBI_NULL;
  for (t = 0; t < f->tables; ++t) {
    if (strcmp(name, f->table[t]->name) != 0) continue;
    pvbi_fail(
        f, PVB_BAD_INPUT,
        t == 0 ? "no table can have the name %s; choose another" : "table %s is declared twice",
        name);
    return PVBI_NULL;
  }
  table = PVBI_CAST(pvbi_table*, calloc(1, sizeof *table));
  if (table == PVBI_NULL) {
    pvbi_fail_memory(f);
    return PVBI_NULL;
  }
  table->number = f->tables;
  table->capacity = capacity;
  memcpy(table->name, name, strlen(name) + 1);
  if (f->tables > 0) (void)snprintf(table->label, sizeof table->label, "table %s: ", table->name);
  f->table[f->tables++] = table;
  return table;
}

// Copies one channel and checks it against those before.
static int pvbi_add_channel(pvb_file* f, pvbi_table* t, const pvb_channel* given) {
  const size_t k = t->channel_count, size = pvbi_type_size(given->type);
  size_t i;
  if (k == PVBI_MAX_CHANNELS) return pvbi_fail(f, PVB_LIMIT, "%smore than 256 channels", t->label);
  if (pvbi_check_name(f, t->label, "channel", k, given->name) != 0) return f->code;
  for (i = 0; i < k; ++i) {
    if (strcmp(given->name, t->names[i]) == 0) {
      return pvbi_fail(f, PVB_BAD_INPUT, "%schannel %s is declared twice", t->label, given->name);
    }
  }
  if (size == 0 || given->components < 1 || given->components > PVBI_MAX_COMPONENTS) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "%schannel %s: type %d with %d components; types are 1 to 7, "
                     "components 1 to 16",
                     t->label, given->name, given->type, given->components);
  }
  if (given->encoding != PVB_PLAIN &&
      (given->encoding != PVB_OCTAHEDRAL || given->type != PVB_U16 || given->components != 2)) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "%schannel %s: its encoding must be plain, or octahedral with "
                     "u16 x 2",
                     t->label, given->name);
  }
  memcpy(t->names[k], given->name, strlen(given->name) + 1);
  t->channels[k] = *given;
  t->channels[k].name = t->names[k];
  t->bytes[k] = size * PVBI_CAST(unsigned, given->components);
  t->channel_count = k + 1;
  return 0;
}

static int pvbi_check_capacity(pvb_file* f, const pvbi_table* t) {
  uint64_t bytes = 0;
  size_t k;
  for (k = 0; k < t->channel_count; ++k) bytes += t->bytes[k];
  if (t->capacity < 1 || t->capacity > PVBI_MAX_RECORDS || t->capacity * bytes > PVBI_MAX_CHUNK) {
    return pvbi_fail(f, PVB_LIMIT,
                     "%schunks of %u records of %llu bytes; a chunk has 1 to 2^24 "
                     "records and at most 1 GiB",
                     t->label, t->capacity, 0ull + bytes);
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

// Checks the channels that a producer declares.
static int pvbi_declare_table(pvb_file* f, const char* name, const pvb_channel* channels,
                              size_t count, uint32_t capacity) {
  pvbi_table* t = pvbi_add_table(f, name, capacity != 0 ? capacity : 65536);
  size_t k;
  if (t == PVBI_NULL) return f->code;
  if (channels == PVBI_NULL || count == 0) {
    return pvbi_fail(f, PVB_USAGE, "%sno channels are given", t->label);
  }
  for (k = 0; k < count; ++k) {
    if (pvbi_add_channel(f, t, &channels[k]) != 0) return f->code;
  }
  return pvbi_check_capacity(f, t);
}

static int pvbi_declare_metadata(pvb_file* f, const char* metadata) {
  const char *first = metadata, *last;
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

// Takes over a name of HEAD, which is padded with zeros.
static int pvbi_get_name(pvb_file* f, const unsigned char* from, char* name) {
  size_t i;
  memcpy(name, from, PVBI_NAME);
  name[PVBI_NAME] = 0;
  for (i = strlen(name); i < PVBI_NAME; ++i) {
    if (name[i] != 0) return pvbi_fail(f, PVB_BAD_INPUT, "HEAD: a name is not padded with zeros");
  }
  return 0;
}

static int pvbi_decode_channels(pvb_file* f, pvbi_table* t, const unsigned char* d, size_t count) {
  size_t k;
  for (k = 0; k < count; ++k, d += PVBI_CHANNEL) {
    char name[PVBI_NAME + 1];
    pvb_channel channel;
    if (pvbi_get_name(f, d, name) != 0) return f->code;
    channel.name = name;
    channel.type = d[56];
    channel.components = d[57];
    channel.encoding = d[58];
    if (pvbi_add_channel(f, t, &channel) != 0) return f->code;
  }
  return pvbi_check_capacity(f, t);
}

// Takes over the tables, from `d` on, of which `size` bytes belong to HEAD.
static int pvbi_decode_tables(pvb_file* f, const unsigned char* d, size_t size) {
  const uint32_t tables = size < PVBI_TABLES ? 0 : pvbi_get32(d);
  size_t place = PVBI_TABLES;
  uint32_t t;
  for (t = 0; t < tables; ++t) {
    char name[PVBI_NAME + 1];
    pvbi_table* table;
    size_t count;
    if (size - place < PVBI_TABLE) break;
    if (pvbi_get_name(f, d + place, name) != 0) return f->code;
    table = pvbi_add_table(f, name, pvbi_get32(d + place + PVBI_NAME));
    if (table == PVBI_NULL) return f->code;
    count = pvbi_get32(d + place + PVBI_NAME + 4);
    place += PVBI_TABLE;
    if (count < 1 || count > (size - place) / PVBI_CHANNEL) break;
    if (pvbi_decode_channels(f, table, d + place, count) != 0) return f->code;
    place += PVBI_CHANNEL * count;
  }
  if (tables == 0 || t < tables) {
    return pvbi_fail(f, PVB_BAD_INPUT, "HEAD: impossible number of tables or of their channels");
  }
  return 0;
}

static int pvbi_decode_head(pvb_file* f, const unsigned char* d, size_t size) {
  const size_t count = size < PVBI_HEAD ? 0 : pvbi_get32(d + 16);
  const size_t text = size < PVBI_HEAD ? 0 : pvbi_get32(d + 20);
  pvbi_table* paths;
  size_t place;
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
  paths = pvbi_add_table(f, "paths", pvbi_get32(d + 12));
  if (paths == PVBI_NULL || pvbi_decode_channels(f, paths, d + PVBI_HEAD, count) != 0) {
    return f->code;
  }
  place = PVBI_HEAD + PVBI_CHANNEL * count;
  if (pvbi_set_metadata(f, d + place, text) != 0 || (pvbi_get32(d + 8) & PVBI_HAS_TABLES) == 0) {
    return f->code;
  }
  place += text;
  return pvbi_decode_tables(f, d + place, size - place);
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
    if (pvbi_decode_commit(f, &frame, &commit)) {
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

static int pvbi_reserve_index(pvb_file* f, pvbi_table* t, uint64_t count) {
  uint64_t room = t->index_room < 64 ? 64 : t->index_room;
  pvbi_entry* grown;
  if (count <= t->index_room) return 0;
  while (room < count) room *= 2;
  if (room > SIZE_MAX / sizeof *grown) return pvbi_fail_memory(f);
  grown = PVBI_CAST(pvbi_entry*, realloc(t->index, (room & SIZE_MAX) * sizeof *grown));
  if (grown == PVBI_NULL) return pvbi_fail_memory(f);
  t->index = grown;
  t->index_room = room & SIZE_MAX;
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

static int pvbi_push(pvb_file* f, pvbi_table* t, const pvbi_entry* entry) {
  if (pvbi_reserve_index(f, t, t->chunks + 1ull) != 0) return f->code;
  t->index[t->chunks++] = *entry;
  return 0;
}

// Whether the index has every record up to the commit, in order. Each pass has paths, but not each
// has records of a table.
static int pvbi_is_complete(const pvb_file* f, const pvbi_table* t, const pvbi_commit* last) {
  const pvbi_total* total = &last->total[t->number];
  const int gaps = t->number > 0;
  uint64_t record = 0, place = f->slot, passes = 0;
  size_t k;
  for (k = 0; k < t->chunks; ++k) {
    const pvbi_entry* e = &t->index[k];
    if (e->first != record || e->count < 1 || e->count > t->capacity || e->offset < place ||
        e->offset % PVBI_PAGE != 0 || e->offset > last->offset ||
        e->length > last->offset - e->offset || e->length < PVBI_PAGE || e->pass >= last->passes ||
        e->pass + 1ull < passes || (e->pass > passes && !gaps)) {
      return 0;
    }
    record += e->count;
    place = e->offset + e->length;
    passes = e->pass + 1ull;
  }
  return record == total->records && t->chunks == total->chunks && (passes == last->passes || gaps);
}

// The first table whose index is not complete, or NULL.
static pvbi_table* pvbi_incomplete(const pvb_file* f, const pvbi_commit* last) {
  size_t t;
  for (t = 0; t < f->tables; ++t) {
    if (!pvbi_is_complete(f, f->table[t], last)) return f->table[t];
  }
  return PVBI_NULL;
}

// Adds what the indices of a commit have: those of the tables from its directory, which is in the
// scratch memory, then that of the paths. Returns 1, 0 where the latter has a wrong checksum, -1 on
// an error.
static int pvbi_push_indices(pvb_file* f, const pvbi_frame* frame, const pvbi_commit* commit) {
  size_t place = PVBI_COMMIT + PVBI_TABLES + PVBI_TOTAL * (f->tables - 1), t;
  pvbi_entry entry;
  uint64_t k;
  int valid;
  for (t = 1; t < f->tables; ++t) {
    for (k = commit->total[t].first_chunk; k < commit->total[t].chunks; ++k, place += PVBI_ENTRY) {
      entry = pvbi_get_entry(frame->directory + place);
      if (pvbi_push(f, f->table[t], &entry) != 0) return -1;
    }
  }
  valid = pvbi_read_section(f, commit, &commit->index);
  for (k = 0; valid == 1 && k < commit->index.length / PVBI_ENTRY; ++k) {
    entry = pvbi_get_entry(f->scratch + k * PVBI_ENTRY);
    if (pvbi_push(f, f->table[0], &entry) != 0) return -1;
  }
  return valid;
}

// Reads the indices from the last commit and its bases, from their ends to their starts. Returns 1,
// 0 where one of them cannot be read, -1 on an error.
static int pvbi_load_index(pvb_file* f, const pvbi_commit* last) {
  uint64_t offset = last->offset, behind[1 + PVBI_MAX_TABLES];
  pvbi_commit at;
  pvbi_frame frame;
  size_t t;
  for (t = 0; t < f->tables; ++t) {
    behind[t] = last->total[t].chunks;
    if (pvbi_reserve_index(f, f->table[t], behind[t]) != 0) return -1;
  }
  for (;;) {
    int valid = pvbi_read_frame(f, offset, &frame);
    if (valid == 1) valid = pvbi_decode_commit(f, &frame, &at);
    if (valid != 1) return valid;
    for (t = 0; t < f->tables; ++t) {
      if (at.total[t].chunks != behind[t]) return 0;
      behind[t] = at.total[t].first_chunk;
      f->table[t]->chunks = behind[t] & SIZE_MAX;
    }
    valid = pvbi_push_indices(f, &frame, &at);
    if (valid != 1) return valid;
    if (behind[0] == 0) break;
    offset = at.base;
  }
  f->leap.offset = offset;
  for (t = 0; t < f->tables; ++t) {
    f->leap.chunks[t] = at.total[t].chunks;
    f->table[t]->chunks = last->total[t].chunks & SIZE_MAX;
  }
  return pvbi_incomplete(f, last) == PVBI_NULL;
}

static int pvbi_compare_entries(const void* a, const void* b) {
  const pvbi_entry *x = PVBI_CAST(const pvbi_entry*, a), *y = PVBI_CAST(const pvbi_entry*, b);
  if (x->first != y->first) return x->first < y->first ? -1 : 1;
  return x->offset < y->offset ? -1 : x->offset > y->offset;
}

// Puts the chunks that were found in order, each once, as far as there are no gaps. Returns the
// first record that is missing.
static uint64_t pvbi_sort_index(pvbi_table* t, uint64_t records) {
  const size_t found = t->chunks;
  uint64_t next = 0;
  size_t k;
  t->chunks = 0;
  if (found > 0) qsort(t->index, found, sizeof *t->index, pvbi_compare_entries);
  for (k = 0; k < found && t->index[k].first < records; ++k) {
    if (t->index[k].first < next) continue;  // another index told it already
    if (t->index[k].first > next) break;
    next += t->index[k].count;
    t->index[t->chunks++] = t->index[k];
  }
  return next;
}

// Rebuilds the indices from every chunk and every index that can be read, where the chain of
// commits is broken.
static int pvbi_scan_index(pvb_file* f, const pvbi_commit* last) {
  uint64_t offset = f->slot, next[1 + PVBI_MAX_TABLES];
  pvbi_frame frame;
  pvbi_commit commit;
  pvbi_entry entry;
  const pvbi_table* bad;
  size_t t;
  int valid;
  for (t = 0; t < f->tables; ++t) f->table[t]->chunks = 0;
  while ((valid = pvbi_next_frame(f, &offset, &frame)) == 1) {
    t = PVBI_MAX_TABLES + 1;
    if (frame.size >= PVBI_CHUNK) {
      if (frame.type == PVBI_TYPE_CHNK) t = 0;
      if (frame.type == PVBI_TYPE_TCHK) t = pvbi_get32(frame.directory + 20);
    }
    if (t < f->tables && (t == 0) == (frame.type == PVBI_TYPE_CHNK)) {
      entry.offset = frame.offset;
      entry.length = frame.length;
      entry.first = pvbi_get64(frame.directory);
      entry.count = pvbi_get32(frame.directory + 8);
      entry.pass = pvbi_get32(frame.directory + 12);
      if (pvbi_push(f, f->table[t], &entry) != 0) return f->code;
    } else if (pvbi_decode_commit(f, &frame, &commit)) {
      if (pvbi_push_indices(f, &frame, &commit) < 0) return f->code;
    }
  }
  if (valid < 0) return f->code;
  for (t = 0; t < f->tables; ++t) {
    next[t] = pvbi_sort_index(f->table[t], last->total[t].records);
  }
  memset(&f->leap, 0, sizeof f->leap);
  bad = pvbi_incomplete(f, last);
  if (bad == PVBI_NULL) return 0;
  return pvbi_fail(f, PVB_BAD_INPUT,
                   "damaged: %sthe chunk with record %llu cannot be found; "
                   "'psf verify' names every fault",
                   bad->label, 0ull + next[bad->number]);
}

// Brings what pvb_about() tells up to date.
static void pvbi_tell(pvb_file* f) {
  const pvbi_table* paths = f->table[0];
  size_t t;
  f->info.records = paths->committed;
  f->info.chunk_capacity = paths->capacity;
  f->info.channels = paths->channels;
  f->info.channel_count = paths->channel_count;
  f->info.table_count = f->tables - 1;
  f->info.tables = f->table_info;
  for (t = 0; t + 1 < f->tables; ++t) {
    const pvbi_table* table = f->table[t + 1];
    f->table_info[t].name = table->name;
    f->table_info[t].records = table->committed;
    f->table_info[t].chunk_capacity = table->capacity;
    f->table_info[t].channels = table->channels;
    f->table_info[t].channel_count = table->channel_count;
  }
}

// Reads everything that a reader and a resumed writer need. `f->fd` is open.
static int pvbi_load(pvb_file* f) {
  struct stat status;
  pvbi_commit last;
  size_t t;
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
  for (t = 0; t < f->tables; ++t) {
    f->previous.chunks[t] = last.total[t].chunks;
    f->table[t]->appended = f->table[t]->committed = last.total[t].records;
  }
  pvbi_tell(f);
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
  static const pvb_info nothing = {0, 0,         0, 0, PVBI_NULL, 0, PVBI_NULL,
                                   0, PVBI_NULL, 0, 0, PVBI_NULL, 0};
  return file == PVBI_NULL || file->mode == PVBI_IDLE ? &nothing : &file->info;
}

const char* pvb_error(const pvb_file* file) {
  if (file == PVBI_NULL) return "out of memory";
  return file->code != 0 ? file->error : PVBI_NULL;
}

static void pvbi_free_table(pvbi_table* t) {
  size_t k;
  for (k = 0; k < PVBI_MAX_CHANNELS; ++k) free(t->column[k]);
  free(t->chunk);
  free(t->index);
  free(t);
}

void pvb_free(pvb_file* file) {
  size_t t;
  if (file == PVBI_NULL) return;
  if (file->mode == PVBI_WRITING && file->partial != PVBI_NULL) {
    (void)unlink(file->partial);
  } else if (file->mode == PVBI_WRITING && file->commits > 0) {
    // Cuts off the uncommitted tail. A failure does no harm, since readers ignore such a tail.
    if (ftruncate(file->fd, PVBI_CAST(off_t, file->committed_end)) != 0) errno = 0;
  }
  if (file->fd >= 0) close(file->fd);
  if (file->replaced >= 0) close(file->replaced);
  for (t = 0; t < file->tables; ++t) pvbi_free_table(file->table[t]);
  free(file->scratch);
  free(file->state);
  free(file->metadata);
  free(file->head);
  free(file->partial);
  free(file->path);
  free(file);
}

// ---- Writing

// Allocates the memory of a full chunk of a table and places every column.
static int pvbi_prepare_chunk(pvb_file* f, pvbi_table* t) {
  uint64_t place = pvbi_up(PVBI_PREFIX + PVBI_CHUNK + PVBI_COLUMN * t->channel_count, PVBI_ALIGN);
  size_t k;
  for (k = 0; k < t->channel_count; ++k) {
    t->place[k] = place & SIZE_MAX;
    place = pvbi_up(place + t->bytes[k] * t->capacity, PVBI_ALIGN);
  }
  t->chunk = PVBI_CAST(unsigned char*, malloc(pvbi_up(place, PVBI_PAGE) & SIZE_MAX));
  return t->chunk == PVBI_NULL ? pvbi_fail_memory(f) : 0;
}

// Allocates all that a writer needs.
static int pvbi_prepare(pvb_file* f) {
  size_t t;
  for (t = 0; t < f->tables; ++t) {
    if (pvbi_prepare_chunk(f, f->table[t]) != 0) return f->code;
  }
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

// Writes the channels of a table to `to`; returns the place behind them.
static unsigned char* pvbi_put_channels(const pvbi_table* t, unsigned char* to) {
  size_t k;
  for (k = 0; k < t->channel_count; ++k, to += PVBI_CHANNEL) {
    memcpy(to, t->names[k], strlen(t->names[k]));
    to[56] = PVBI_CAST(unsigned char, t->channels[k].type);
    to[57] = PVBI_CAST(unsigned char, t->channels[k].components);
    to[58] = PVBI_CAST(unsigned char, t->channels[k].encoding);
  }
  return to;
}

static size_t pvbi_head_size(const pvb_file* f) {
  size_t size = PVBI_HEAD + f->info.metadata_size, t;
  for (t = 0; t < f->tables; ++t) size += PVBI_CHANNEL * f->table[t]->channel_count;
  if (f->tables > 1) size += PVBI_TABLES + PVBI_TABLE * (f->tables - 1);
  return size;
}

// Writes HEAD and an empty SLOT.
static int pvbi_write_start(pvb_file* f) {
  const pvbi_table* paths = f->table[0];
  const uint32_t size = pvbi_head_size(f) & 0xFFFFFFFFu;
  const size_t length = pvbi_up(PVBI_PREFIX + size, PVBI_PAGE) & SIZE_MAX;
  unsigned char page[PVBI_PAGE] = {0}, *d;
  size_t t;
  f->head_size = PVBI_PREFIX + size;
  f->head = PVBI_CAST(unsigned char*, calloc(1, length));
  if (f->head == PVBI_NULL) return pvbi_fail_memory(f);
  d = f->head + PVBI_PREFIX;
  d[0] = 1;  // version 1.0, or
  if (f->tables > 1) {
    d[2] = 1;  // 1.1 with tables
    pvbi_put32(d + 8, PVBI_HAS_TABLES);
  }
  pvbi_put32(d + 12, paths->capacity);
  pvbi_put32(d + 16, paths->channel_count & 0xFFFFFFFFu);
  pvbi_put32(d + 20, f->info.metadata_size & 0xFFFFFFFFu);
  d = pvbi_put_channels(paths, d + PVBI_HEAD);
  memcpy(d, f->metadata, f->info.metadata_size);
  d += f->info.metadata_size;
  if (f->tables > 1) {
    pvbi_put32(d, (f->tables - 1) & 0xFFFFFFFFu);
    d += PVBI_TABLES;
  }
  for (t = 1; t < f->tables; ++t) {
    const pvbi_table* table = f->table[t];
    memcpy(d, table->name, strlen(table->name));
    pvbi_put32(d + PVBI_NAME, table->capacity);
    pvbi_put32(d + PVBI_NAME + 4, table->channel_count & 0xFFFFFFFFu);
    d = pvbi_put_channels(table, d + PVBI_TABLE);
  }
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

// Checks the declarations of a producer.
static int pvbi_declare(pvb_file* f, const pvb_channel* channels, size_t channel_count,
                        const pvb_table* tables, size_t table_count, const char* metadata,
                        const pvb_options* options) {
  const uint32_t capacity = options != PVBI_NULL ? options->chunk_capacity : 0;
  size_t t;
  if (pvbi_declare_table(f, "paths", channels, channel_count, capacity) != 0) return f->code;
  if (table_count > 0 && tables == PVBI_NULL) return pvbi_fail(f, PVB_USAGE, "no tables are given");
  for (t = 0; t < table_count; ++t) {
    if (pvbi_declare_table(f, tables[t].name, tables[t].channels, tables[t].channel_count,
                           tables[t].chunk_capacity) != 0) {
      return f->code;
    }
  }
  if (pvbi_declare_metadata(f, metadata) != 0) return f->code;
  pvbi_tell(f);
  return 0;
}

pvb_file* pvb_create(const char* path, const pvb_channel* channels, size_t channel_count,
                     const char* metadata, const pvb_options* options) {
  return pvb_create_with(path, channels, channel_count, PVBI_NULL, 0, metadata, options);
}

pvb_file* pvb_create_with(const char* path, const pvb_channel* channels, size_t channel_count,
                          const pvb_table* tables, size_t table_count, const char* metadata,
                          const pvb_options* options) {
  const char* slash;
  size_t kept;
  pvb_file* f = pvbi_new(path);
  if (f == PVBI_NULL || f->code != 0) return f;
  f->no_sync = options != PVBI_NULL && options->no_sync;
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
  if (pvbi_declare(f, channels, channel_count, tables, table_count, metadata, options) != 0 ||
      pvbi_make_uuid(f, options) != 0 || pvbi_prepare(f) != 0 || pvbi_hold_replaced(f) != 0) {
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

// Refuses channels that are not those of a table of the file.
static int pvbi_check_channels(pvb_file* f, const pvbi_table* t, const pvb_channel* channels,
                               size_t count) {
  size_t k;
  for (k = 0; k < count || k < t->channel_count; ++k) {
    const pvb_channel *a = &channels[k], *b = &t->channels[k];
    if (k < count && k < t->channel_count && a->name != PVBI_NULL &&
        strcmp(a->name, b->name) == 0 && a->type == b->type && a->components == b->components &&
        a->encoding == b->encoding) {
      continue;
    }
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "cannot be resumed: %schannel %u (%s) is not the same; write "
                     "another file",
                     t->label, PVBI_CAST(unsigned, k), k < t->channel_count ? b->name : "none");
  }
  return 0;
}

// Refuses tables that are not those of the file.
static int pvbi_check_tables(pvb_file* f, const pvb_table* tables, size_t count) {
  size_t t;
  for (t = 0; t < count || t + 1 < f->tables; ++t) {
    const pvbi_table* own = t + 1 < f->tables ? f->table[t + 1] : PVBI_NULL;
    if (t >= count || own == PVBI_NULL || tables[t].name == PVBI_NULL ||
        strcmp(tables[t].name, own->name) != 0) {
      return pvbi_fail(f, PVB_BAD_INPUT,
                       "cannot be resumed: table %u (%s) is not the same; write "
                       "another file",
                       PVBI_CAST(unsigned, t), own != PVBI_NULL ? own->name : "none");
    }
    if (pvbi_check_channels(f, own, tables[t].channels, tables[t].channel_count) != 0) {
      return f->code;
    }
  }
  return 0;
}

// Refuses metadata that are not those of the file, and what this version cannot go on with.
static int pvbi_check_rest(pvb_file* f, const char* metadata) {
  const unsigned char* d = f->head + PVBI_PREFIX;
  if (metadata == PVBI_NULL || strlen(metadata) != f->info.metadata_size ||
      memcmp(metadata, f->metadata, f->info.metadata_size) != 0) {
    return pvbi_fail(f, PVB_BAD_INPUT,
                     "cannot be resumed: its metadata is not the same; write "
                     "another file");
  }
  if ((d[2] | d[3] << 8) > 1 || (pvbi_get32(d + 8) | PVBI_HAS_TABLES) != PVBI_HAS_TABLES) {
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
  return pvb_resume_with(path, channels, channel_count, PVBI_NULL, 0, metadata, options);
}

pvb_file* pvb_resume_with(const char* path, const pvb_channel* channels, size_t channel_count,
                          const pvb_table* tables, size_t table_count, const char* metadata,
                          const pvb_options* options) {
  pvb_file* f = pvbi_new(path);
  if (f == PVBI_NULL || f->code != 0) return f;
  f->no_sync = options != PVBI_NULL && options->no_sync;
  f->fd = pvbi_open_locked(f, path, O_RDWR);
  if (f->fd < 0 || pvbi_load(f) != 0 ||
      pvbi_check_channels(f, f->table[0], channels, channel_count) != 0 ||
      pvbi_check_tables(f, tables, table_count) != 0 || pvbi_check_rest(f, metadata) != 0 ||
      pvbi_prepare(f) != 0) {
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

// Writes the chunk of a table that is being filled. Where it is not full, its columns move
// together.
static int pvbi_flush(pvb_file* f, pvbi_table* t) {
  const uint32_t number = t->number & 0xFFFFFFFFu, channels = t->channel_count & 0xFFFFFFFFu;
  const uint32_t size = PVBI_CHUNK + PVBI_COLUMN * channels;
  unsigned char* d = t->chunk + PVBI_PREFIX;
  size_t k, place = PVBI_PREFIX + size, length;
  pvbi_entry entry;
  if (t->filled == 0) return 0;
  if (f->info.passes >= UINT32_MAX) return pvbi_fail(f, PVB_LIMIT, "more than 2^32 - 1 passes");
  memset(d, 0, size);
  pvbi_put64(d, t->appended);
  pvbi_put32(d + 8, t->filled);
  pvbi_put32(d + 12, f->info.passes & 0xFFFFFFFFu);
  pvbi_put32(d + 16, channels);
  pvbi_put32(d + 20, number);
  for (k = 0; k < channels; ++k) {
    unsigned char* column = d + PVBI_CHUNK + PVBI_COLUMN * k;
    const size_t stored = t->bytes[k] * t->filled;
    const size_t start = pvbi_up(place, PVBI_ALIGN) & SIZE_MAX;
    memset(t->chunk + place, 0, start - place);
    if (start != t->place[k]) memmove(t->chunk + start, t->chunk + t->place[k], stored);
    pvbi_put32(column, k & 0xFFFFu);  // codec raw, no filter
    pvbi_put32(column + 4, pvbi_crc(f, 0, t->chunk + start, stored));
    pvbi_put64(column + 8, start);
    pvbi_put64(column + 16, stored);
    place = start + stored;
  }
  length = pvbi_up(place, PVBI_PAGE) & SIZE_MAX;
  memset(t->chunk + place, 0, length - place);
  pvbi_put_prefix(f, t->chunk, number == 0 ? PVBI_TYPE_CHNK : PVBI_TYPE_TCHK, number == 0, length,
                  size);
  entry.offset = f->end;
  entry.length = length;
  entry.first = t->appended;
  entry.count = t->filled;
  entry.pass = f->info.passes & 0xFFFFFFFFu;
  if (pvbi_push(f, t, &entry) != 0 || pvbi_write_frame(f, t->chunk, length) != 0) return f->code;
  t->appended += t->filled;
  t->filled = 0;
  return 0;
}

// The table of this number, the paths being 0. Every call in `mode` that asks for one starts here.
static pvbi_table* pvbi_enter_table(pvb_file* f, int mode, size_t number) {
  if (pvbi_enter(f, mode) != 0) return PVBI_NULL;
  if (number < f->tables) return f->table[number];
  pvbi_fail(f, PVB_USAGE, "has no such table; it has %u", PVBI_CAST(unsigned, f->tables - 1));
  return PVBI_NULL;
}

static int pvbi_append(pvb_file* f, size_t table, size_t count, const pvb_array* arrays) {
  pvbi_table* t = pvbi_enter_table(f, PVBI_WRITING, table);
  size_t done = 0, k;
  if (t == PVBI_NULL) return f == PVBI_NULL ? PVB_LIMIT : f->code;
  if (count > 0 && arrays == PVBI_NULL) {
    return pvbi_fail(f, PVB_USAGE, "%sno arrays are given", t->label);
  }
  for (k = 0; k < t->channel_count && count > 0; ++k) {
    if (arrays[k].data == PVBI_NULL) {
      return pvbi_fail(f, PVB_USAGE, "%sno values are given for channel %s", t->label, t->names[k]);
    }
  }
  if (count > INT64_MAX - t->appended - t->filled) {
    return pvbi_fail(f, PVB_LIMIT, "%smore than 2^63 records", t->label);
  }
  while (done < count) {
    // Copies few records at a time, so that the structs are still in the cache for their next
    // member.
    const size_t room = t->capacity - t->filled, most = room < 256 ? room : 256;
    const size_t taken = count - done < most ? count - done : most;
    for (k = 0; k < t->channel_count; ++k) {
      const size_t size = t->bytes[k], stride = arrays[k].stride;
      pvbi_copy(t->chunk + t->place[k] + size * t->filled, size,
                PVBI_CAST(const unsigned char*, arrays[k].data) + done * stride, stride, size,
                taken);
    }
    t->filled += taken & 0xFFFFFFFFu;
    done += taken;
    if (t->filled == t->capacity && pvbi_flush(f, t) != 0) return f->code;
  }
  return 0;
}

int pvb_append(pvb_file* file, size_t count, const pvb_array* arrays) {
  return pvbi_append(file, 0, count, arrays);
}

int pvb_append_to(pvb_file* file, size_t table, size_t count, const pvb_array* arrays) {
  return pvbi_append(file, PVBI_TABLE_NUMBER(table), count, arrays);
}

// Puts one section of a commit at its place; returns the place of the next.
static uint64_t pvbi_put_section(const pvb_file* f, unsigned char* frame, unsigned char* entry,
                                 uint64_t place, size_t length) {
  pvbi_put64(entry, place);
  pvbi_put64(entry + 8, length);
  pvbi_put32(entry + 16, pvbi_crc(f, 0, frame + place, length));
  return pvbi_up(place + length, PVBI_ALIGN);
}

static void pvbi_put_entries(const pvbi_table* t, uint64_t first, unsigned char* to) {
  size_t k;
  for (k = first & SIZE_MAX; k < t->chunks; ++k, to += PVBI_ENTRY) {
    const pvbi_entry* entry = &t->index[k];
    pvbi_put64(to, entry->offset);
    pvbi_put64(to + 8, entry->length);
    pvbi_put64(to + 16, entry->first);
    pvbi_put32(to + 24, entry->count);
    pvbi_put32(to + 28, entry->pass);
  }
}

// Size of the directory of a commit whose indices start behind `base`.
static uint64_t pvbi_commit_size(const pvb_file* f, const pvbi_anchor* base) {
  uint64_t size = PVBI_COMMIT;
  size_t t;
  if (f->tables > 1) size += PVBI_TABLES;
  for (t = 1; t < f->tables; ++t) {
    size += PVBI_TOTAL + (f->table[t]->chunks - base->chunks[t]) * PVBI_ENTRY;
  }
  return size;
}

// Puts the totals and the indices of the tables into the directory of a commit.
static void pvbi_put_totals(const pvb_file* f, unsigned char* d, const pvbi_anchor* base) {
  unsigned char* entries = d + PVBI_TABLES + PVBI_TOTAL * (f->tables - 1);
  size_t t;
  pvbi_put32(d, (f->tables - 1) & 0xFFFFFFFFu);
  for (t = 1; t < f->tables; ++t) {
    const pvbi_table* table = f->table[t];
    unsigned char* total = d + PVBI_TABLES + PVBI_TOTAL * (t - 1);
    pvbi_put64(total, table->appended);
    pvbi_put64(total + 8, table->chunks);
    pvbi_put64(total + 16, base->chunks[t]);
    pvbi_put_entries(table, base->chunks[t], entries);
    entries += (table->chunks - base->chunks[t]) * PVBI_ENTRY;
  }
}

// Builds the frame CMIT. The commit has the number f->commits + 1, and its indices start behind
// `base`.
static unsigned char* pvbi_make_commit(pvb_file* f, uint32_t flags, uint64_t passes,
                                       const pvbi_anchor* base, size_t* length) {
  const pvbi_table* paths = f->table[0];
  const uint32_t size = pvbi_commit_size(f, base) & 0xFFFFFFFFu;
  const size_t index_size = (paths->chunks - (base->chunks[0] & SIZE_MAX)) * PVBI_ENTRY;
  const uint64_t index = pvbi_up(PVBI_PREFIX + 0ull + size, PVBI_ALIGN);
  const uint64_t head = pvbi_up(index + index_size, PVBI_ALIGN);
  const uint64_t state = pvbi_up(head + f->head_size, PVBI_ALIGN);
  unsigned char *frame, *d;
  *length = pvbi_up(state + f->info.state_size, PVBI_PAGE) & SIZE_MAX;
  frame = PVBI_CAST(unsigned char*, calloc(1, *length));
  if (frame == PVBI_NULL) {
    pvbi_fail_memory(f);
    return PVBI_NULL;
  }
  d = frame + PVBI_PREFIX;
  pvbi_put32(d, flags);
  pvbi_put64(d + 8, f->commits + 1);
  pvbi_put64(d + 16, paths->appended);
  pvbi_put64(d + 24, paths->chunks);
  pvbi_put64(d + 32, passes);
  pvbi_put64(d + 40, f->previous.offset);
  pvbi_put64(d + 48, base->offset);
  pvbi_put64(d + 56, base->chunks[0]);
  if (f->tables > 1) pvbi_put_totals(f, d + PVBI_COMMIT, base);
  pvbi_put_entries(paths, base->chunks[0], frame + index);
  memcpy(frame + head, f->head, f->head_size);
  memcpy(frame + state, f->state, f->info.state_size);
  pvbi_put_section(f, frame, d + 72, index, index_size);
  pvbi_put_section(f, frame, d + 96, head, f->head_size);
  pvbi_put_section(f, frame, d + 120, state, f->info.state_size);
  pvbi_put_prefix(f, frame, PVBI_TYPE_CMIT, 1, *length, size);
  return frame;
}

// The commit whose indices the next one builds on: by the rule of README.md, "The index", or the
// next of that rule with which the tables' indices fit into a directory. Returns NULL where none
// does.
static const pvbi_anchor* pvbi_choose_base(pvb_file* f, uint32_t flags) {
  static const pvbi_anchor none = {0, {0}};
  const uint64_t number = f->commits + 1;
  const pvbi_anchor* rule[3];
  size_t k = flags != 0 || number % PVBI_LEAP == 0 ? 0 : number % PVBI_STEP == 0 ? 1 : 2;
  rule[0] = &none;
  rule[1] = &f->leap;
  rule[2] = &f->previous;
  for (; k < 3; ++k) {
    if (pvbi_commit_size(f, rule[k]) <= PVBI_MAX_DIRECTORY) return rule[k];
  }
  pvbi_fail(f, PVB_LIMIT,
            "the tables have more chunks in this pass than a commit can name; "
            "use larger chunks");
  return PVBI_NULL;
}

static int pvbi_write_commit(pvb_file* f, uint32_t flags, uint64_t passes) {
  const uint64_t number = f->commits + 1, offset = f->end;
  const pvbi_anchor* base = pvbi_choose_base(f, flags);
  unsigned char slot[PVBI_SLOT_RECORD], *frame;
  size_t length, t;
  int whole;
  if (base == PVBI_NULL || pvbi_sync(f) != 0) return f->code;
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
  whole = base != &f->leap && base != &f->previous;
  f->commits = number;
  f->committed_end = f->end;
  f->previous.offset = offset;
  for (t = 0; t < f->tables; ++t) {
    f->previous.chunks[t] = f->table[t]->chunks;
    f->table[t]->committed = f->table[t]->appended;
  }
  if (whole) f->leap = f->previous;
  pvbi_tell(f);
  f->info.passes = passes;
  f->info.closed = flags != 0;
  f->info.uncommitted = 0;
  return 0;
}

int pvb_commit(pvb_file* file, const void* state, size_t state_size) {
  size_t t;
  if (pvbi_enter(file, PVBI_WRITING) != 0) return file == PVBI_NULL ? PVB_LIMIT : file->code;
  if (state_size > PVBI_MAX_STATE || (state == PVBI_NULL && state_size > 0)) {
    return pvbi_fail(file, PVB_LIMIT, "%llu bytes of resume state; at most 65536 fit",
                     0ull + state_size);
  }
  for (t = 0; t < file->tables; ++t) {
    if (pvbi_flush(file, file->table[t]) != 0) return file->code;
  }
  if (file->table[0]->appended == file->table[0]->committed) {
    return pvbi_fail(file, PVB_USAGE, "a pass without records cannot be committed");
  }
  if (state_size > 0) memmove(file->state, state, state_size);
  file->info.state_size = state_size;
  return pvbi_write_commit(file, 0, file->info.passes + 1);
}

int pvb_close(pvb_file* file) {
  size_t t;
  int result;
  if (pvbi_enter(file, PVBI_WRITING) != 0) return file == PVBI_NULL ? PVB_LIMIT : file->code;
  for (t = 0; t < file->tables; ++t) {
    const pvbi_table* table = file->table[t];
    if (table->filled > 0 || table->appended != table->committed) {
      return pvbi_fail(file, PVB_USAGE, "%srecords were appended but not committed", table->label);
    }
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
  if (f == PVBI_NULL || f->code != 0) return f;
  // Without O_NONBLOCK, opening a named pipe would wait for a writer.
  f->fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (f->fd < 0) {
    pvbi_fail_io(f, "open");
    return f;
  }
  if (pvbi_load(f) == 0) f->mode = PVBI_READING;
  return f;
}

static int pvbi_find(const pvb_channel* channels, size_t count, const char* channel) {
  size_t k;
  for (k = 0; k < count; ++k) {
    if (strcmp(channels[k].name, channel) == 0) return PVBI_CAST(int, k);
  }
  return -1;
}

int pvb_find(const pvb_file* file, const char* channel) {
  const pvb_info* info = pvb_about(file);
  return pvbi_find(info->channels, info->channel_count, channel);
}

int pvb_find_table(const pvb_file* file, const char* table) {
  const pvb_info* info = pvb_about(file);
  size_t t;
  for (t = 0; t < info->table_count; ++t) {
    if (strcmp(info->tables[t].name, table) == 0) return PVBI_CAST(int, t);
  }
  return -1;
}

int pvb_find_in(const pvb_file* file, size_t table, const char* channel) {
  const pvb_info* info = pvb_about(file);
  if (table >= info->table_count) return -1;
  return pvbi_find(info->tables[table].channels, info->tables[table].channel_count, channel);
}

// The first record of a table that is not of a pass before this one.
static uint64_t pvbi_pass_start(const pvbi_table* t, uint64_t pass) {
  size_t low = 0, high = t->chunks;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (t->index[middle].pass < pass) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low < t->chunks ? t->index[low].first : t->committed;
}

static int pvbi_pass(pvb_file* f, size_t table, uint64_t pass, uint64_t* first, uint64_t* count) {
  const pvbi_table* t = pvbi_enter_table(f, PVBI_READING, table);
  if (t == PVBI_NULL) return f == PVBI_NULL ? PVB_LIMIT : f->code;
  if (pass >= f->info.passes) {
    return pvbi_fail(f, PVB_USAGE, "has %llu passes; pass %llu is asked for", 0ull + f->info.passes,
                     0ull + pass);
  }
  *first = pvbi_pass_start(t, pass);
  *count = pvbi_pass_start(t, pass + 1) - *first;
  return 0;
}

int pvb_pass(pvb_file* file, uint64_t pass, uint64_t* first, uint64_t* count) {
  return pvbi_pass(file, 0, pass, first, count);
}

int pvb_pass_of(pvb_file* file, size_t table, uint64_t pass, uint64_t* first, uint64_t* count) {
  return pvbi_pass(file, PVBI_TABLE_NUMBER(table), pass, first, count);
}

// Reads a column of a chunk to t->column[channel]. Returns NULL, or the reason why it cannot.
static const char* pvbi_load_column(pvb_file* f, pvbi_table* t, size_t chunk, size_t channel) {
  const pvbi_entry* e = &t->index[chunk];
  const size_t size = t->bytes[channel] * e->count;
  const unsigned char *d, *column;
  pvbi_frame frame;
  uint64_t offset;
  uint32_t crc, kind;
  const int valid = pvbi_read_frame(f, e->offset, &frame);
  if (valid < 0) return f->error;
  d = frame.directory;
  if (!valid || frame.type != (t->number == 0 ? PVBI_TYPE_CHNK : PVBI_TYPE_TCHK) ||
      frame.length != e->length || frame.size < PVBI_CHUNK + PVBI_COLUMN * t->channel_count ||
      pvbi_get64(d) != e->first || pvbi_get32(d + 8) != e->count || pvbi_get32(d + 12) != e->pass ||
      pvbi_get32(d + 16) != t->channel_count ||
      (t->number > 0 && pvbi_get32(d + 20) != t->number)) {
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
  t->column_chunk[channel] = 0;
  free(t->column[channel]);
  t->column[channel] = PVBI_CAST(unsigned char*, malloc(size));
  if (t->column[channel] == PVBI_NULL) return "out of memory";
  if (pvbi_pread(f, e->offset + offset, t->column[channel], size) != 0) return f->error;
  if (pvbi_crc(f, 0, t->column[channel], size) != crc) {
    return "its checksum is wrong; 'psf verify' names every fault";
  }
  t->column_chunk[channel] = chunk + 1;
  return PVBI_NULL;
}

static int pvbi_read(pvb_file* f, size_t table, size_t channel, uint64_t first, size_t count,
                     void* out, size_t stride) {
  pvbi_table* t = pvbi_enter_table(f, PVBI_READING, table);
  unsigned char* to = PVBI_CAST(unsigned char*, out);
  size_t low = 0, high, chunk;
  if (t == PVBI_NULL) return f == PVBI_NULL ? PVB_LIMIT : f->code;
  if (channel >= t->channel_count) {
    return pvbi_fail(f, PVB_USAGE, "%shas no channel %llu", t->label, 0ull + channel);
  }
  if (first > t->committed || count > t->committed - first) {
    return pvbi_fail(f, PVB_USAGE, "%sholds %llu records; %llu from %llu on are asked for",
                     t->label, 0ull + t->committed, 0ull + count, 0ull + first);
  }
  if (count > 0 && (out == PVBI_NULL || stride < t->bytes[channel])) {
    return pvbi_fail(f, PVB_USAGE, "%schannel %s has %u bytes a record; the stride is less",
                     t->label, t->names[channel], PVBI_CAST(unsigned, t->bytes[channel]));
  }
  for (high = t->chunks; high - low > 1;) {  // the chunk of `first` is in [low, high)
    const size_t middle = low + (high - low) / 2;
    *(t->index[middle].first <= first ? &low : &high) = middle;
  }
  for (chunk = low; count > 0; ++chunk) {
    const pvbi_entry* e = &t->index[chunk];
    const uint64_t skipped = first - e->first;
    const size_t left = (e->count - skipped) & SIZE_MAX, taken = left < count ? left : count;
    const size_t size = t->bytes[channel];
    if (t->column_chunk[channel] != chunk + 1) {
      const char* why = pvbi_load_column(f, t, chunk, channel);
      if (why == f->error) return f->code;
      if (why != PVBI_NULL) {
        return pvbi_fail(f, PVB_BAD_INPUT, "%schunk %llu (records %llu-%llu), channel %s: %s",
                         t->label, 0ull + chunk, 0ull + e->first, e->first + e->count - 1ull,
                         t->names[channel], why);
      }
    }
    pvbi_copy(to, stride, t->column[channel] + skipped * size, size, size, taken);
    to += taken * stride;
    first += taken;
    count -= taken;
  }
  return 0;
}

int pvb_read(pvb_file* file, size_t channel, uint64_t first, size_t count, void* out,
             size_t stride) {
  return pvbi_read(file, 0, channel, first, count, out, stride);
}

int pvb_read_from(pvb_file* file, size_t table, size_t channel, uint64_t first, size_t count,
                  void* out, size_t stride) {
  return pvbi_read(file, PVBI_TABLE_NUMBER(table), channel, first, count, out, stride);
}

#endif  // PVB_IMPLEMENTATION
