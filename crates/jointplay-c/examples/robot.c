/* The three-rod robot and a mechanism from C.
   cc robot.c $(pkg-config --cflags --libs jointplay) -o robot */
#include <jointplay.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Ends the program with the text of the error. */
static void check(int32_t code) {
    if (code == JP_OK) return;
    size_t size = jp_last_error(NULL, 0);
    char *text = malloc(size);
    jp_last_error(text, size);
    fprintf(stderr, "error %d: %s\n", (int)code, text);
    free(text);
    exit(code);
}

int main(void) {
    struct JpRobot *robot = NULL;
    check(jp_robot_paper(&robot));
    double rods[3], pose[16], joints[JP_MAX_VIRTUAL_JOINTS];
    double degree = acos(-1.0) / 180.0;
    check(jp_robot_inverse(robot, 17 * degree, 1.5 * degree, 0.5, rods));
    printf("rods (mm)            %.6f %.6f %.6f\n", 1e3 * rods[0], 1e3 * rods[1], 1e3 * rods[2]);
    check(jp_robot_forward(robot, JP_RADIAL, rods, pose, joints, NULL));
    printf("shift (um)           %.3f %.3f\n", 1e6 * pose[3], 1e6 * pose[7]);
    printf("virtual joints (um) ");
    for (size_t k = 0; k < jp_virtual_joint_count(JP_RADIAL); k++) printf(" %.3f", 1e6 * joints[k]);
    printf("\n");

    int32_t exceeded[4];
    double too_long[3] = {0.9, 0.5, 0.5};
    check(jp_robot_limits(robot, too_long, exceeded));
    printf("limits exceeded      %d %d %d, tilt %d\n", exceeded[0], exceeded[1], exceeded[2], exceeded[3]);

    char *answer = NULL;
    check(jp_robot_json(robot, "{\"kind\": \"mobility\"}", &answer));
    printf("mobility in JSON     %s\n", strstr(answer, "\"finite_mobility\":1") ? "1" : "?");
    jp_text_free(answer);
    jp_robot_free(robot);

    /* A mechanism with virtual joints: drives in, link poses out. */
    struct JpMechanism *mechanism = NULL;
    check(jp_mechanism_catalogue("gpr-mechanism", &mechanism));
    size_t count = jp_mechanism_coordinate_count(mechanism);
    size_t links = jp_mechanism_link_count(mechanism);
    double *positions = malloc(count * sizeof *positions);
    double *poses = malloc(16 * links * sizeof *poses);
    check(jp_mechanism_home(mechanism, positions));
    for (int step = 1; step <= 10; step++) {
        double drives[3] = {-2.3e-4 * step, 0.5e-4 * step, 1.8e-4 * step};
        check(jp_mechanism_positions(mechanism, drives, positions));
    }
    check(jp_mechanism_link_poses(mechanism, positions, poses));
    const double *last = poses + 16 * (links - 1);
    printf("%-20s %.3f %.3f %.3f mm\n", jp_mechanism_link_name(mechanism, links - 1), 1e3 * last[3], 1e3 * last[7],
           1e3 * last[11]);
    free(poses);
    free(positions);
    jp_mechanism_free(mechanism);

    /* Invalid input is a code and a text. */
    printf("unknown mechanism    %d\n", (int)jp_mechanism_catalogue("nothing", &mechanism));
    return 0;
}
