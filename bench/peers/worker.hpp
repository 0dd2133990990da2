// What the compiled workers of the bench share: the work as told, and how they answer.
//
// A worker prints "ready", then answers "run N" by doing all of its work N times, and "write FILE" by writing its answers;
// some also answer "call N" by N single calls.
#pragma once

#include <array>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

// A rotation by rows, and a point.
struct Frame {
  double rotation[9];
  double point[3];
};

inline std::istream& operator>>(std::istream& in, Frame& frame) {
  for (double& number : frame.rotation) in >> number;
  for (double& number : frame.point) in >> number;
  return in;
}

// The three-rod robot, and the rods of each pose.
struct GprWork {
  double radius[3], direction[3][2], base[3][2];
  double metric, height, gap;
  std::vector<std::array<double, 3>> poses;

  explicit GprWork(std::istream& in) {
    for (int k = 0; k < 3; ++k) in >> radius[k] >> direction[k][0] >> direction[k][1] >> base[k][0] >> base[k][1];
    size_t count = 0;
    in >> metric >> height >> gap >> count;
    poses.resize(count);
    for (auto& rods : poses) in >> rods[0] >> rods[1] >> rods[2];
    if (!in) throw std::runtime_error("the work cannot be read");
  }
};

// A body that hangs on another by a joint about or along z, or by a ball.
struct Body {
  int parent;
  char kind;
  bool driven;
  Frame in_parent;
};

struct Side {
  int body;
  Frame frame;
};

// What closes a loop: a hinge or a ball.
struct Cut {
  char kind;
  Side sides[2];
};

// A mechanism, and the coordinates that each of its positions is searched from.
struct LinkageWork {
  std::vector<Body> bodies;
  std::vector<Cut> cuts;
  double gap;
  std::vector<std::vector<double>> guesses;

  explicit LinkageWork(std::istream& in) {
    size_t body_count = 0, cut_count = 0, steps = 0, width = 0;
    in >> body_count >> cut_count;
    bodies.resize(body_count);
    for (auto& body : bodies) {
      in >> body.parent >> body.kind >> body.driven >> body.in_parent;
      width += body.kind == 'S' ? 4 : 1;
    }
    cuts.resize(cut_count);
    for (auto& cut : cuts) {
      in >> cut.kind >> cut.sides[0].body >> cut.sides[1].body >> cut.sides[0].frame >> cut.sides[1].frame;
    }
    in >> gap >> steps;
    guesses.assign(steps, std::vector<double>(width));
    for (auto& guess : guesses) {
      for (double& number : guess) in >> number;
    }
    if (!in) throw std::runtime_error("the work cannot be read");
  }
};

class Work {
 public:
  virtual ~Work() = default;
  // Solves everything; how many were solved.
  virtual int solve() = 0;
  // Solves that many positions by a call each; how many were solved.
  virtual int call(int) { throw std::runtime_error("this worker does not answer single calls"); }

  virtual void write(const std::string& path) {
    FILE* out = std::fopen(path.c_str(), "w");
    if (!out) throw std::runtime_error("cannot write " + path);
    for (const auto& answer : answers_) {
      for (double number : answer) std::fprintf(out, "%.17g ", number);
      std::fprintf(out, "\n");
    }
    std::fclose(out);
  }

 protected:
  std::vector<std::vector<double>> answers_;
};

// Answers for one worker, whose work is made of what it is called and of a file: WHAT FILE.
template <class Make>
int serve(int count, char** words, Make make) {
  if (count != 3) {
    std::cerr << "say: WHAT FILE\n";
    return 2;
  }
  try {
    std::ifstream file(words[2]);
    std::unique_ptr<Work> work = make(words[1], file);
    if (!work) throw std::runtime_error(std::string("there is no work called ") + words[1]);
    std::cout << "ready" << std::endl;
    std::string line;
    while (std::getline(std::cin, line)) {
      std::istringstream said(line);
      std::string what, rest;
      said >> what >> rest;
      if (what == "run") {
        int solved = 0;
        for (int times = std::stoi(rest); times > 0; --times) solved = work->solve();
        std::cout << "done " << solved << std::endl;
      } else if (what == "call") {
        std::cout << "done " << work->call(std::stoi(rest)) << std::endl;
      } else if (what == "write") {
        work->write(rest);
        std::cout << "done" << std::endl;
      } else {
        throw std::runtime_error("expected run N, call N or write FILE");
      }
    }
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}

// The same for workers of the robot and of linkages: gpr FILE or linkage FILE.
template <class Gpr, class Linkage>
int serve(int count, char** words) {
  return serve(count, words, [](const std::string& what, std::istream& in) -> std::unique_ptr<Work> {
    if (what == "gpr") return std::make_unique<Gpr>(in);
    if (what == "linkage") return std::make_unique<Linkage>(in);
    return nullptr;
  });
}
