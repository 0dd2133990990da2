// Workload and commands of the compiled workers of the bench.
//
// A worker prints "ready", then reads commands: "run N" computes the whole work N times, "write FILE" writes the answers,
// and with some workers "call N" performs N single calls.
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

// Pose: a rotation matrix by rows, and a point [m].
struct Frame {
  double rotation[9];
  double point[3];
};

inline std::istream& operator>>(std::istream& in, Frame& frame) {
  for (double& number : frame.rotation) in >> number;
  for (double& number : frame.point) in >> number;
  return in;
}

// Workload of the three-rod robot: its dimensions, and the rods of each pose [m].
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
    if (!in) throw std::runtime_error("the file of the workload cannot be read");
  }
};

// Body that is connected to its parent by a joint about or along z, or by a ball joint.
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

// Joint that closes a loop: a hinge or a ball joint.
struct Cut {
  char kind;
  Side sides[2];
};

// Workload of a mechanism: its bodies and cuts, and the initial guess of each position.
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
    if (!in) throw std::runtime_error("the file of the workload cannot be read");
  }
};

class Work {
 public:
  virtual ~Work() = default;
  // Computes the whole work, and returns the number of solved positions.
  virtual int solve() = 0;
  // Computes as many positions by single calls, and returns the number of solved positions.
  virtual int call(int) { throw std::runtime_error("this worker does not support the command call"); }

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

// Runs a worker with the arguments WHAT FILE: the name of its work, and the file of the workload.
template <class Make>
int serve(int count, char** words, Make make) {
  if (count != 3) {
    std::cerr << "usage: WHAT FILE\n";
    return 2;
  }
  try {
    std::ifstream file(words[2]);
    std::unique_ptr<Work> work = make(words[1], file);
    if (!work) throw std::runtime_error(std::string("unknown work ") + words[1]);
    std::cout << "ready" << std::endl;
    std::string line;
    while (std::getline(std::cin, line)) {
      std::istringstream words_of_line(line);
      std::string command, argument;
      words_of_line >> command >> argument;
      if (command == "run") {
        int solved = 0;
        for (int times = std::stoi(argument); times > 0; --times) solved = work->solve();
        std::cout << "done " << solved << std::endl;
      } else if (command == "call") {
        std::cout << "done " << work->call(std::stoi(argument)) << std::endl;
      } else if (command == "write") {
        work->write(argument);
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

// Runs a worker for the robot or for linkages, with the arguments gpr FILE or linkage FILE.
template <class Gpr, class Linkage>
int serve(int count, char** words) {
  return serve(count, words, [](const std::string& what, std::istream& in) -> std::unique_ptr<Work> {
    if (what == "gpr") return std::make_unique<Gpr>(in);
    if (what == "linkage") return std::make_unique<Linkage>(in);
    return nullptr;
  });
}
