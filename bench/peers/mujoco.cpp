// Worker for the workloads of the bench with the kinematics of MuJoCo, through its C interface.
//
// Usage: mujoco gpr FILE, mujoco linkage FILE; the model is FILE with the extension .xml; worker.hpp describes the commands.
// The solver of MuJoCo has soft loop constraints, and does not solve for positions. A Newton iteration with full steps
// uses the kinematics and Jacobians of MuJoCo. MuJoCo solves positive definite systems only, so Eigen solves the small systems.
#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "newton.hpp"
#include "worker.hpp"

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Jacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int kIterations = 50;

struct Model {
  mjModel* model;
  mjData* data;

  explicit Model(const std::string& path) {
    char error[500] = "";
    model = mj_loadXML(path.c_str(), nullptr, error, sizeof error);
    if (!model) throw std::runtime_error(error);
    data = mj_makeData(model);
  }
  ~Model() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  Model(const Model&) = delete;
};

class Gpr : public Work {
 public:
  Gpr(std::istream& in, const std::string& xml) : work_(in), mujoco_(xml) {
    for (int k = 0; k < 3; ++k) {
      // Bodies of MuJoCo: 0 is the world, 1 the platform, 2 to 4 have the rotation and the slide of each limb.
      bodies_[k] = 2 + k;
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
    const auto [m, d] = std::pair(mujoco_.model, mujoco_.data);
    std::copy(m->qpos0, m->qpos0 + m->nq, d->qpos);
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      mj_kinematics(m, d);
      Eigen::Matrix<double, 9, 1> gap;
      for (int k = 0; k < 3; ++k) {
        const Vector3d ball(work_.base[k][0], work_.base[k][1], rods[k]);
        gap.segment<3>(3 * k) = Eigen::Map<const Vector3d>(d->xpos + 3 * bodies_[k]) - ball;
      }
      if (!(gap.cwiseAbs().maxCoeff() > work_.gap)) {
        write(answer);
        return true;
      }
      mj_comPos(m, d);
      Eigen::Matrix<double, 9, 6> platform;
      Eigen::Matrix<double, 9, 6> virtual_part = Eigen::Matrix<double, 9, 6>::Zero();
      for (int k = 0; k < 3; ++k) {
        Eigen::Matrix<double, 3, 12, Eigen::RowMajor> jacobian;
        mj_jac(m, d, jacobian.data(), nullptr, d->xpos + 3 * bodies_[k], bodies_[k]);
        platform.middleRows<3>(3 * k) = jacobian.leftCols<6>();
        virtual_part.block<3, 2>(3 * k, 2 * k) = jacobian.middleCols<2>(6 + 2 * k);
      }
      // The free platform closes as much of the gap as possible; the virtual joints close the rest, with minimum norm.
      const Eigen::HouseholderQR<Eigen::Matrix<double, 9, 6>> qr(platform);
      virtual_part.applyOnTheLeft(qr.householderQ().adjoint());
      gap.applyOnTheLeft(qr.householderQ().adjoint());
      const Eigen::Matrix<double, 3, 6> open = virtual_part.bottomRows<3>();
      const Eigen::Matrix<double, 6, 3> weighted = compliance_.asDiagonal() * open.transpose();
      const Eigen::Matrix3d gram = open * weighted;
      Eigen::Matrix<double, 12, 1> step;
      step.tail<6>() = -weighted * gram.llt().solve(gap.tail<3>());
      step.head<6>() = -qr.matrixQR().topRows<6>().triangularView<Eigen::Upper>().solve(
          gap.head<6>() + virtual_part.topRows<6>() * step.tail<6>());
      mj_integratePos(m, d->qpos, step.data(), 1.0);
    }
    return false;
  }

  void write(std::vector<double>& answer) const {
    const mjData* d = mujoco_.data;
    answer.assign(d->xmat + 9, d->xmat + 18);
    answer.insert(answer.end(), d->xpos + 3, d->xpos + 6);
    for (int k = 0; k < 3; ++k) answer.push_back(work_.radius[k] + d->qpos[7 + 2 * k + 1]);
    for (int k = 0; k < 3; ++k) answer.push_back(d->qpos[7 + 2 * k]);
  }

  GprWork work_;
  Model mujoco_;
  int bodies_[3];
  Eigen::Matrix<double, 6, 1> compliance_;
};

class Linkage : public Work {
 public:
  Linkage(std::istream& in, const std::string& xml) : work_(in), mujoco_(xml) {
    const mjModel* m = mujoco_.model;
    for (int joint = 0; joint < m->njnt; ++joint) {
      const int width = m->jnt_type[joint] == mjJNT_BALL ? 3 : 1;
      for (int k = 0; k < width && !work_.bodies[joint].driven; ++k) free_.push_back(m->jnt_dofadr[joint] + k);
    }
    for (const auto& cut : work_.cuts) {
      closings_.push_back({cut.kind == 'R', rows_, {closing_side(cut.sides[0]), closing_side(cut.sides[1])}});
      rows_ += cut.kind == 'R' ? 5 : 3;
    }
    gap_.resize(rows_);
    jacobian_.resize(rows_, free_.size());
    linear_.resize(3, m->nv);
    angular_.resize(3, m->nv);
    step_ = VectorXd::Zero(m->nv);
  }

  int solve() override {
    answers_.assign(work_.guesses.size(), {});
    int solved = 0;
    for (size_t k = 0; k < work_.guesses.size(); ++k) solved += solve_one(work_.guesses[k], answers_[k]);
    return solved;
  }

 private:
  bool solve_one(const std::vector<double>& guess, std::vector<double>& answer) {
    const auto [m, d] = std::pair(mujoco_.model, mujoco_.data);
    // The file has the order of MuJoCo: bodies as listed, quaternions of balls with w first.
    std::copy(guess.begin(), guess.end(), d->qpos);
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      mj_kinematics(m, d);
      fill(false);
      if (!(gap_.cwiseAbs().maxCoeff() > work_.gap)) {
        answer.assign(d->qpos, d->qpos + m->nq);
        return true;
      }
      mj_comPos(m, d);
      fill(true);
      newton_.solve(jacobian_, gap_, passive_);
      for (size_t k = 0; k < free_.size(); ++k) step_[free_[k]] = -passive_[k];
      mj_integratePos(m, d->qpos, step_.data(), 1.0);
    }
    return false;
  }

  // One side of a cut, and the free columns that move it.
  struct ClosingSide {
    int body;
    Vector3d point;
    Eigen::Matrix3d rotation;
    std::vector<int> columns;
  };
  struct Closing {
    bool hinge;
    int row;
    ClosingSide sides[2];
  };

  ClosingSide closing_side(const Side& side_in_file) const {
    using Rotation = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    ClosingSide side{side_in_file.body + 1, Eigen::Map<const Vector3d>(side_in_file.frame.point),
                     Eigen::Map<const Rotation>(side_in_file.frame.rotation), {}};
    const mjModel* m = mujoco_.model;
    for (size_t k = 0; k < free_.size(); ++k) {
      for (int body = side.body; body > 0; body = m->body_parentid[body]) {
        if (m->dof_bodyid[free_[k]] == body) side.columns.push_back(k);
      }
    }
    return side;
  }

  void fill(bool derivatives) {
    using Rotation = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const auto [m, d] = std::pair(mujoco_.model, mujoco_.data);
    if (derivatives) jacobian_.setZero();
    for (const auto& closing : closings_) {
      Vector3d points[2];
      Eigen::Matrix3d rotations[2];
      for (int side = 0; side < 2; ++side) {
        const auto& [body, point, rotation, columns] = closing.sides[side];
        const Eigen::Map<const Rotation> rotation_of_body(d->xmat + 9 * body);
        points[side] = rotation_of_body * point + Eigen::Map<const Vector3d>(d->xpos + 3 * body);
        if (closing.hinge) rotations[side] = rotation_of_body * rotation;
      }
      const auto x = rotations[0].col(0), y = rotations[0].col(1), z = rotations[1].col(2);
      const int row = closing.row;
      if (!derivatives) {
        gap_.segment<3>(row) = points[1] - points[0];
        if (closing.hinge) gap_.segment<2>(row + 3) << x.dot(z), y.dot(z);
        continue;
      }
      Vector3d about_x, about_y;
      // x · z changes by (ω₂ − ω₁) · (z × x).
      if (closing.hinge) about_x = z.cross(x), about_y = z.cross(y);
      for (int side = 0; side < 2; ++side) {
        if (closing.sides[side].body == 0) continue;
        const double sign = side == 0 ? -1.0 : 1.0;
        mj_jac(m, d, linear_.data(), closing.hinge ? angular_.data() : nullptr, points[side].data(),
               closing.sides[side].body);
        for (const int k : closing.sides[side].columns) {
          jacobian_.block<3, 1>(row, k) += sign * linear_.col(free_[k]);
          if (!closing.hinge) continue;
          jacobian_(row + 3, k) += sign * angular_.col(free_[k]).dot(about_x);
          jacobian_(row + 4, k) += sign * angular_.col(free_[k]).dot(about_y);
        }
      }
    }
  }

  LinkageWork work_;
  Model mujoco_;
  std::vector<int> free_;
  std::vector<Closing> closings_;
  int rows_ = 0;
  VectorXd gap_, step_, passive_;
  MatrixXd jacobian_;
  Jacobian linear_, angular_;
  NewtonStep newton_;
};

int main(int count, char** words) {
  static const std::string path = count == 3 ? words[2] : "";
  static const std::string xml = path.substr(0, path.rfind('.')) + ".xml";
  struct NamedGpr : Gpr {
    explicit NamedGpr(std::istream& in) : Gpr(in, xml) {}
  };
  struct NamedLinkage : Linkage {
    explicit NamedLinkage(std::istream& in) : Linkage(in, xml) {}
  };
  return serve<NamedGpr, NamedLinkage>(count, words);
}
