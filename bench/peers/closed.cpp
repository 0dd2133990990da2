// Worker for the closed equations with a compiled kernel of closed/: `closed x FILE`, `closed pose FILE` or `closed least FILE`.
//
// In addition to the commands of all workers, "call N" solves N poses by single calls, each of which depends on the
// result of the previous one.
#include "closed/closed.h"

#include "worker.hpp"

class Closed : public Work {
 public:
  Closed(std::istream& in, closed_want want) : want_(want) {
    GprWork work(in);
    for (int k = 0; k < 3; ++k) {
      robot_.radius[k] = work.radius[k];
      for (int axis = 0; axis < 2; ++axis) {
        robot_.direction[k][axis] = work.direction[k][axis];
        robot_.base[k][axis] = work.base[k][axis];
      }
      for (const auto& rods : work.poses) rods_[k].push_back(rods[k]);
    }
    robot_.metric = work.metric;
    robot_.gap = work.gap;
    columns_.resize(want == CLOSED_POSE ? CLOSED_POSE_COLUMNS : CLOSED_X_COLUMNS);
    for (auto& column : columns_) {
      column.resize(work.poses.size());
      out_.push_back(column.data());
    }
  }

  int solve() override {
    const double* const rods[3] = {rods_[0].data(), rods_[1].data(), rods_[2].data()};
    return static_cast<int>(closed_many(&robot_, want_, rods_[0].size(), rods, out_.data()));
  }

  int call(int times) override {
    // The added zero is a data dependency: the processor waits for the result of the previous call.
    volatile double none = 0.0;
    const double nothing = none;
    double x[6] = {};
    int solved = 0;
    for (size_t at = 0; times > 0; --times) {
      const double rods[3] = {rods_[0][at] + nothing * x[0], rods_[1][at], rods_[2][at] + nothing * x[5]};
      solved += closed_one(&robot_, rods, x);
      at = at + 1 < rods_[0].size() ? at + 1 : 0;
    }
    return solved;
  }

  // Answers are rotation, point and X if the pose is requested, otherwise X.
  void write(const std::string& path) override {
    const size_t count = rods_[0].size();
    answers_.assign(count, {});
    for (size_t at = 0; at < count; ++at) {
      if (!(columns_[6][at] <= robot_.gap)) continue;
      for (size_t m = 7; m < columns_.size(); ++m) answers_[at].push_back(columns_[m][at]);
      for (size_t m = 0; m < 6; ++m) answers_[at].push_back(columns_[m][at]);
    }
    Work::write(path);
  }

 private:
  closed_want want_;
  closed_robot robot_{};
  std::vector<double> rods_[3];
  std::vector<std::vector<double>> columns_;
  std::vector<double*> out_;
};

int main(int count, char** words) {
  const std::map<std::string, closed_want> wants = {{"x", CLOSED_X}, {"pose", CLOSED_POSE}, {"least", CLOSED_LEAST}};
  return serve(count, words, [&](const std::string& what, std::istream& in) -> std::unique_ptr<Work> {
    const auto want = wants.find(what);
    return want == wants.end() ? nullptr : std::make_unique<Closed>(in, want->second);
  });
}
