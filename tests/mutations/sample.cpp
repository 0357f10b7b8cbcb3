// SPDX-License-Identifier: Apache-2.0
// For sample_test.py: a function of each kind of change with checks that notice it, one without checks, and text that
// is not mutated.
namespace {

constexpr int kLimit = 3 + 4;
static_assert(kLimit < 8);
const char* const kText = "5 < 6";

bool is_below(int value) { return value < kLimit; }
bool is_within(int value, int least) { return value >= least && is_below(value); }
double area(double width, double height) { return width * height; }
int status(int value) {
  if (value == 0) return -2;
  return value;
}
int count(int value) {
  int total = 40;
  total += value;
  return total;
}
bool untested(int value) { return value > 9; }

}  // namespace

int main() {
  const bool below = is_below(6) && !is_below(7);
  const bool within = is_within(2, 2) && !is_within(1, 2) && !is_within(9, 2);
  const bool others = area(3, 2) == 6 && status(0) == -2 && status(5) == 5 && count(2) == 42;
  (void)untested(20);
  return below && within && others && kText[0] == '5' ? 0 : 1;
}
