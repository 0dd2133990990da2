// Worker for the workloads of the bench with the kinematics of Pinocchio, from C++.
//
// Usage: pinocchio gpr FILE, pinocchio linkage FILE; worker.hpp describes the commands.
// Pinocchio is compiled from its headers, so that the compiler can inline its functions.
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/multibody.hpp>

#include <Eigen/Dense>
#include <algorithm>

#include "newton.hpp"
#include "worker.hpp"

namespace pin = pinocchio;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kIterations = 50;

// The three-rod robot: a free platform with three rotations about its centre, a slide on each, and a point on each slide.
class Gpr : public Work {
 public:
  explicit Gpr(std::istream& in) : work_(in) {
    platform_ = model_.addJoint(0, pin::JointModelFreeFlyer(), pin::SE3::Identity(), "platform");
    for (int k = 0; k < 3; ++k) {
      const auto number = std::to_string(k);
      const auto turn = model_.addJoint(platform_, pin::JointModelRZ(), pin::SE3::Identity(), "turn" + number);
      const Vector3d out(work_.direction[k][0], work_.direction[k][1], 0.0);
      const pin::SE3 place(Eigen::Matrix3d::Identity(), work_.radius[k] * out);
      slides_[k] = model_.addJoint(turn, pin::JointModelPrismaticUnaligned(out), place, "slide" + number);
    }
    data_ = pin::Data(model_);
    rest_ = pin::neutral(model_);
    rest_[2] = work_.height;
    next_ = rest_;
    step_.resize(model_.nv);
    // Columns: 0 to 5 for the platform, then rotation and slide of each limb.
    for (int k = 0; k < 3; ++k) {
      compliance_[2 * k] = 1.0 / (work_.metric * work_.metric);
      compliance_[2 * k + 1] = 1.0;
    }
  }

  int solve() override {
    answers_.assign(work_.poses.size(), {});
    int solved = 0;
    for (size_t pose = 0; pose < work_.poses.size(); ++pose) solved += solve_one(work_.poses[pose], answers_[pose]);
    return solved;
  }

 private:
  bool solve_one(const std::array<double, 3>& rods, std::vector<double>& answer) {
    q_ = rest_;
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      pin::forwardKinematics(model_, data_, q_);
      Eigen::Matrix<double, 9, 1> gap;
      for (int k = 0; k < 3; ++k) {
        const Vector3d ball(work_.base[k][0], work_.base[k][1], rods[k]);
        gap.segment<3>(3 * k) = data_.oMi[slides_[k]].translation() - ball;
      }
      if (!(gap.cwiseAbs().maxCoeff() > work_.gap)) {
        write(answer);
        return true;
      }
      pin::computeJointJacobians(model_, data_);
      Eigen::Matrix<double, 9, 6> platform;
      Eigen::Matrix<double, 9, 6> virtual_part = Eigen::Matrix<double, 9, 6>::Zero();
      for (int k = 0; k < 3; ++k) {
        // Columns of Data::J are spatial velocities at the origin; the velocity of a point adds angular × point.
        const Vector3d point = data_.oMi[slides_[k]].translation();
        const auto at_point = [&](int column) -> Vector3d {
          return data_.J.col(column).head<3>() + Vector3d(data_.J.col(column).tail<3>()).cross(point);
        };
        for (int column = 0; column < 6; ++column) platform.block<3, 1>(3 * k, column) = at_point(column);
        for (int own = 0; own < 2; ++own) virtual_part.block<3, 1>(3 * k, 2 * k + own) = at_point(6 + 2 * k + own);
      }
      // The free platform closes as much of the gap as possible; the virtual joints close the rest, with minimum norm.
      const Eigen::HouseholderQR<Eigen::Matrix<double, 9, 6>> qr(platform);
      virtual_part.applyOnTheLeft(qr.householderQ().adjoint());
      gap.applyOnTheLeft(qr.householderQ().adjoint());
      const Eigen::Matrix<double, 3, 6> open = virtual_part.bottomRows<3>();
      const Eigen::Matrix<double, 6, 3> weighted = compliance_.asDiagonal() * open.transpose();
      const Eigen::Matrix3d gram = open * weighted;
      const Eigen::Matrix<double, 6, 1> give = -weighted * gram.llt().solve(gap.tail<3>());
      step_.tail<6>() = give;
      step_.head<6>() = -qr.matrixQR().topRows<6>().triangularView<Eigen::Upper>().solve(
          gap.head<6>() + virtual_part.topRows<6>() * give);
      pin::integrate(model_, q_, step_, next_);
      q_.swap(next_);
    }
    return false;
  }

  void write(std::vector<double>& answer) const {
    const auto& pose = data_.oMi[platform_];
    answer.resize(18);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) answer[3 * row + column] = pose.rotation()(row, column);
      answer[9 + row] = pose.translation()[row];
      answer[12 + row] = work_.radius[row] + q_[model_.idx_qs[slides_[row]]];
      answer[15 + row] = q_[model_.idx_qs[slides_[row] - 1]];
    }
  }

  GprWork work_;
  pin::Model model_;
  pin::Data data_;
  pin::JointIndex platform_, slides_[3];
  Eigen::Matrix<double, 6, 1> compliance_;
  VectorXd rest_, q_, next_, step_;
};

// A tree of bodies with loops closed by points, and by axes for hinges.
class Linkage : public Work {
 public:
  explicit Linkage(std::istream& in) : work_(in) {
    for (size_t body = 0; body < work_.bodies.size(); ++body) {
      const auto& body_in_file = work_.bodies[body];
      const pin::JointIndex parent = body_in_file.parent < 0 ? 0 : joints_[body_in_file.parent];
      const pin::SE3 place = frame(body_in_file.in_parent);
      const auto name = "body" + std::to_string(body);
      if (body_in_file.kind == 'R') joints_.push_back(model_.addJoint(parent, pin::JointModelRZ(), place, name));
      if (body_in_file.kind == 'P') joints_.push_back(model_.addJoint(parent, pin::JointModelPZ(), place, name));
      if (body_in_file.kind == 'S') joints_.push_back(model_.addJoint(parent, pin::JointModelSpherical(), place, name));
    }
    data_ = pin::Data(model_);
    for (size_t body = 0; body < joints_.size(); ++body) {
      if (work_.bodies[body].driven) continue;
      for (int k = 0; k < model_.nvs[joints_[body]]; ++k) free_.push_back(model_.idx_vs[joints_[body]] + k);
    }
    for (const auto& cut : work_.cuts) {
      closings_.push_back({cut.kind == 'R', rows_, {closing_side(cut.sides[0]), closing_side(cut.sides[1])}});
      rows_ += cut.kind == 'R' ? 5 : 3;
    }
    gap_.resize(rows_);
    jacobian_ = MatrixXd::Zero(rows_, free_.size());
    next_ = q_ = pin::neutral(model_);
    step_ = VectorXd::Zero(model_.nv);
  }

  int solve() override {
    answers_.assign(work_.guesses.size(), {});
    int solved = 0;
    for (size_t k = 0; k < work_.guesses.size(); ++k) solved += solve_one(work_.guesses[k], answers_[k]);
    return solved;
  }

 private:
  static pin::SE3 frame(const Frame& frame_in_file) {
    pin::SE3 place;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) place.rotation()(row, column) = frame_in_file.rotation[3 * row + column];
      place.translation()[row] = frame_in_file.point[row];
    }
    return place;
  }

  bool solve_one(const std::vector<double>& guess, std::vector<double>& answer) {
    size_t at = 0;
    for (size_t body = 0; body < joints_.size(); ++body) {
      const int first = model_.idx_qs[joints_[body]];
      if (work_.bodies[body].kind == 'S') {
        // Quaternions are w, x, y, z in the file, and x, y, z, w in Pinocchio.
        for (int k = 0; k < 4; ++k) q_[first + (k + 3) % 4] = guess[at + k];
        at += 4;
      } else {
        q_[first] = guess[at++];
      }
    }
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      pin::forwardKinematics(model_, data_, q_);
      fill(false);
      if (!(gap_.cwiseAbs().maxCoeff() > work_.gap)) {
        write(answer);
        return true;
      }
      pin::computeJointJacobians(model_, data_);
      fill(true);
      newton_.solve(jacobian_, gap_, passive_);
      for (size_t k = 0; k < free_.size(); ++k) step_[free_[k]] = -passive_[k];
      pin::integrate(model_, q_, step_, next_);
      q_.swap(next_);
    }
    return false;
  }

  // One side of a cut: its pose on the body, and the free columns that move it.
  struct ClosingSide {
    pin::JointIndex joint;
    pin::SE3 on_body;
    std::vector<int> columns;
  };
  struct Closing {
    bool hinge;
    int row;
    ClosingSide sides[2];
  };

  ClosingSide closing_side(const Side& side_in_file) const {
    ClosingSide side{side_in_file.body < 0 ? 0 : joints_[side_in_file.body], frame(side_in_file.frame), {}};
    const auto& supports = model_.supports[side.joint];
    for (size_t k = 0; k < free_.size(); ++k) {
      const auto moves = [&](pin::JointIndex joint) {
        return joint > 0 && free_[k] >= model_.idx_vs[joint] && free_[k] < model_.idx_vs[joint] + model_.nvs[joint];
      };
      if (std::any_of(supports.begin(), supports.end(), moves)) side.columns.push_back(k);
    }
    return side;
  }

  void fill(bool derivatives) {
    if (derivatives) jacobian_.setZero();
    for (const auto& closing : closings_) {
      const pin::SE3 first = data_.oMi[closing.sides[0].joint] * closing.sides[0].on_body;
      const pin::SE3 second = data_.oMi[closing.sides[1].joint] * closing.sides[1].on_body;
      const auto x = first.rotation().col(0), y = first.rotation().col(1), z = second.rotation().col(2);
      const int row = closing.row;
      if (!derivatives) {
        gap_.segment<3>(row) = second.translation() - first.translation();
        if (closing.hinge) gap_.segment<2>(row + 3) << x.dot(z), y.dot(z);
        continue;
      }
      // x · z changes by (ω₂ − ω₁) · (z × x).
      const Vector3d about_x = z.cross(x), about_y = z.cross(y);
      for (int side = 0; side < 2; ++side) {
        const double sign = side == 0 ? -1.0 : 1.0;
        const Vector3d& point = (side == 0 ? first : second).translation();
        for (const int k : closing.sides[side].columns) {
          const Vector3d linear = data_.J.col(free_[k]).head<3>(), angular = data_.J.col(free_[k]).tail<3>();
          jacobian_.block<3, 1>(row, k) += sign * (linear + angular.cross(point));
          if (!closing.hinge) continue;
          jacobian_(row + 3, k) += sign * angular.dot(about_x);
          jacobian_(row + 4, k) += sign * angular.dot(about_y);
        }
      }
    }
  }

  void write(std::vector<double>& answer) const {
    for (size_t body = 0; body < joints_.size(); ++body) {
      const int first = model_.idx_qs[joints_[body]];
      const bool ball = work_.bodies[body].kind == 'S';
      for (int k = 0; k < (ball ? 4 : 1); ++k) answer.push_back(q_[ball ? first + (k + 3) % 4 : first]);
    }
  }

  LinkageWork work_;
  pin::Model model_;
  pin::Data data_;
  std::vector<pin::JointIndex> joints_;
  std::vector<int> free_;
  std::vector<Closing> closings_;
  int rows_ = 0;
  VectorXd q_, next_, step_, gap_;
  MatrixXd jacobian_;
  VectorXd passive_;
  NewtonStep newton_;
};

int main(int count, char** words) { return serve<Gpr, Linkage>(count, words); }
