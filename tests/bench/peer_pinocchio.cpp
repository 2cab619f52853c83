// Pinocchio's articulated-body algorithm on a chain of revolute joints, timed inside C++.
//
//   peer_pinocchio FILE CALLS
//
// FILE: number of joints; gravity (3 numbers); then for each joint: axis (1, 2, 3), place of the joint in the axes of
// the link before (3), mass, mass centre (3), inertia about the mass centre (xx xy yy xz yz zz); then q, q', tau.
// Prints nanoseconds per call (the smallest of several rounds), then q''.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "pinocchio/multibody.hpp"
#include "pinocchio/multibody/joint.hpp"
#include "pinocchio/algorithm/aba.hpp"



// Short rounds: the smallest is one that nothing interrupted.
constexpr int ROUNDS = 300;

int main(int count, char** words) {
    if (count < 3) return 2;
    std::ifstream in(words[1]);
    const long calls = std::atol(words[2]);
    int joints = 0;
    Eigen::Vector3d gravity;
    in >> joints >> gravity[0] >> gravity[1] >> gravity[2];
    pinocchio::Model model;
    model.gravity.linear() = gravity;
    pinocchio::JointIndex parent = 0;
    for (int k = 0; k < joints; ++k) {
        int axis = 0;
        double mass = 0, xx, xy, yy, xz, yz, zz;
        Eigen::Vector3d place, centre;
        in >> axis >> place[0] >> place[1] >> place[2] >> mass >> centre[0] >> centre[1] >> centre[2];
        in >> xx >> xy >> yy >> xz >> yz >> zz;
        const pinocchio::SE3 placement(Eigen::Matrix3d::Identity(), place);
        const std::string name = "joint" + std::to_string(k + 1);
        if (axis == 1) parent = model.addJoint(parent, pinocchio::JointModelRX(), placement, name);
        if (axis == 2) parent = model.addJoint(parent, pinocchio::JointModelRY(), placement, name);
        if (axis == 3) parent = model.addJoint(parent, pinocchio::JointModelRZ(), placement, name);
        Eigen::Matrix3d inertia;
        inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
        model.appendBodyToJoint(parent, pinocchio::Inertia(mass, centre, inertia), pinocchio::SE3::Identity());
    }
    Eigen::VectorXd q(joints), v(joints), tau(joints);
    for (int k = 0; k < joints; ++k) in >> q[k];
    for (int k = 0; k < joints; ++k) in >> v[k];
    for (int k = 0; k < joints; ++k) in >> tau[k];
    if (!in) return 3;
    pinocchio::Data data(model);
    double best = 1e300, sum = 0;
    for (int round = 0; round < ROUNDS; ++round) {
        const auto start = std::chrono::steady_clock::now();
        for (long i = 0; i < calls; ++i) {
            q[0] += 1e-9;  // a new state every time
            sum += pinocchio::aba(model, data, q, v, tau)[0];
        }
        const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - start;
        best = std::min(best, spent.count() / calls);
    }
    for (int k = 0; k < joints; ++k) q[k] -= k == 0 ? 1e-9 * ROUNDS * calls : 0.0;
    pinocchio::aba(model, data, q, v, tau);
    std::printf("%.6f\n", best);
    for (int k = 0; k < joints; ++k) std::printf("%.17g\n", data.ddq[k]);
    std::fprintf(stderr, "%g\n", sum);
    return 0;
}
