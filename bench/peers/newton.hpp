// Newton steps for the compiled workers, with the fastest decomposition for the shape of the equations.
#pragma once

#include <Eigen/Dense>

// Solves J step = gap: by least squares for more equations than unknowns (redundant constraints), by minimum norm for
// fewer (idle rotations of rods). The normal equations reduce the precision of a step, which the next step corrects.
class NewtonStep {
 public:
  void solve(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& gap, Eigen::VectorXd& step) {
    if (jacobian.rows() == jacobian.cols()) {
      square_.compute(jacobian);
      step.noalias() = square_.solve(gap);
    } else if (jacobian.rows() > jacobian.cols()) {
      normal_.noalias() = jacobian.transpose() * jacobian;
      projected_.noalias() = jacobian.transpose() * gap;
      cholesky_.compute(normal_);
      step = cholesky_.solve(projected_);
    } else {
      normal_.noalias() = jacobian * jacobian.transpose();
      cholesky_.compute(normal_);
      projected_ = cholesky_.solve(gap);
      step.noalias() = jacobian.transpose() * projected_;
    }
  }

 private:
  Eigen::MatrixXd normal_;
  Eigen::VectorXd projected_;
  Eigen::PartialPivLU<Eigen::MatrixXd> square_;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
};
