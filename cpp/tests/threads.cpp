// Runs the tests of a core in several threads at once, as loops side by side step their own parts.
#undef main  // a core's own main is core_main here
#include <array>
#include <thread>

int core_main();

int main() {
  std::array<int, 3> codes{};
  std::array<std::thread, 3> threads;
  for (std::size_t i = 0; i < threads.size(); ++i) threads[i] = std::thread([&codes, i] { codes[i] = core_main(); });
  for (std::thread& thread : threads) thread.join();
  for (int code : codes)
    if (code) return code;
  return 0;
}
