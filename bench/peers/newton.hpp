// Steps of Newton's iteration for the compiled workers: the quickest way for the shape of the equations.
#pragma once

#include <Eigen/Dense>

// Solves J step = gap: with more equations than unknowns by least squares (some are redundant), with fewer by least norm
// (rods spin idly). The normal equations lose digits of a step, which the next step makes good.
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
