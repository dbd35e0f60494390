// Message records of a block of ticks, as they stand in a log: one row of bytes per tick.
#pragma once
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace pliant::telemetry {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "a log has little-endian numbers");

// A record in a row: where it begins, the number of its first message, where its stamp begins (-1: none).
struct Record {
  int64_t begin;
  uint32_t first;
  int64_t stamp;
};

// A channel's numbers: those of a tick stand side by side, `step` after those of the tick before; the bytes of a row at
// which they go.
struct Column {
  const double* numbers;
  long step;
  std::vector<int64_t> places;

  bool together() const {
    for (size_t i = 1; i < places.size(); ++i)
      if (places[i] != places[i - 1] + 8) return false;
    return true;
  }
};

// Opcode, length and channel stand before the sequence number; then come log time and publish time.
constexpr int64_t kSequence = 11, kLogTime = 15, kPublishTime = 23, kHead = 31;

template <class T>
void put(char* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

// Whether all that is written stands in a row of so many bytes.
inline bool stands_within(const std::vector<Record>& records, const std::vector<Column>& columns, int64_t width) {
  for (const Record& record : records)
    if (record.begin < 0 || record.begin + kHead > width || record.stamp < -1 || record.stamp + 8 > width) return false;
  for (const Column& column : columns)
    for (const int64_t place : column.places)
      if (place < 0 || place + 8 > width) return false;
  return true;
}

// Fills the rows (ticks, width): the template with numbers, sequence, times [ns] and stamps in it.
inline void pack(const char* shape, int64_t width, const std::vector<Record>& records,
                 const std::vector<Column>& columns, const int64_t* times, long ticks, char* rows) {
  std::vector<bool> together;
  for (const Column& column : columns) together.push_back(column.together());
  for (long tick = 0; tick < ticks; ++tick) {
    char* row = rows + tick * width;
    std::memcpy(row, shape, size_t(width));
    const int64_t time = times[tick], second = 1'000'000'000;
    const int64_t seconds = time / second - (time % second < 0), rest = time - seconds * second;
    for (const Record& record : records) {
      put(row + record.begin + kSequence, uint32_t(record.first + uint32_t(tick)));
      put(row + record.begin + kLogTime, uint64_t(time));
      put(row + record.begin + kPublishTime, uint64_t(time));
      if (record.stamp < 0) continue;
      put(row + record.stamp, int32_t(seconds));
      put(row + record.stamp + 4, uint32_t(rest));
    }
    for (size_t c = 0; c < columns.size(); ++c) {
      const std::vector<int64_t>& places = columns[c].places;
      const double* from = columns[c].numbers + tick * columns[c].step;
      if (together[c] && !places.empty()) {
        std::memcpy(row + places[0], from, 8 * places.size());
        continue;
      }
      for (size_t i = 0; i < places.size(); ++i) put(row + places[i], from[i]);
    }
  }
}

}  // namespace pliant::telemetry
