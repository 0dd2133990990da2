// The three-rod robot from C++, freed by its owner, in several threads.
// c++ -std=c++17 robot.cpp $(pkg-config --cflags --libs jointplay) -pthread -o robot
#include <jointplay.h>

#include <array>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

static void check(int32_t code) {
    if (code == JP_OK) return;
    std::string text(jp_last_error(nullptr, 0), '\0');
    jp_last_error(text.data(), text.size());
    throw std::runtime_error(text.c_str());
}

using Robot = std::unique_ptr<JpRobot, decltype(&jp_robot_free)>;

static Robot paper() {
    JpRobot *made = nullptr;
    check(jp_robot_paper(&made));
    return Robot(made, jp_robot_free);
}

int main() {
    const Robot robot = paper();
    const double height = jp_robot_working_height(robot.get());
    std::array<double, 4> shifts{};
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < shifts.size(); k++) {
        threads.emplace_back([&, k] {
            double rods[3], pose[16];
            check(jp_robot_inverse(robot.get(), 0.0, 0.008 * double(k), height, rods));
            check(jp_robot_forward(robot.get(), JP_PLANAR, rods, pose, nullptr, nullptr));
            shifts[k] = 1e6 * pose[3];
        });
    }
    for (auto &thread : threads) thread.join();
    for (std::size_t k = 0; k < shifts.size(); k++) std::printf("tilt %.3f rad, shift %.3f um\n", 0.008 * double(k), shifts[k]);
    try {
        double rods[3];
        check(jp_robot_inverse(robot.get(), 0.0, 2.0, height, rods));
    } catch (const std::runtime_error &error) {
        std::printf("error: %s\n", error.what());
    }
}
