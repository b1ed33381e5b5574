// The works of benches/works/mod.rs done with Pinocchio and Eigen: `pinocchio URDF NAME COUNT`.
//
// As with the Rust side, the program is run with two counts and the difference is taken. The step is that of the
// six-instant look-ahead formula of Wang and Guo (2020) on two arms with full poses: kinematics, Jacobian, residual,
// Cholesky (LDLT) solve of the normal equations and combination of the history. It watches no limits and no errors,
// and its path is computed beforehand.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/model.hpp>
#include <pinocchio/parsers/urdf.hpp>
#include <pinocchio/spatial.hpp>
#include <string>
#include <vector>

using Vector7 = Eigen::Matrix<double, 7, 1>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
// Static sizes, so that the peer is as quick as it can be.
using Jacobian = Eigen::Matrix<double, 6, 7>;

namespace {

constexpr int STEPS = 20000;
constexpr double SIGMA = 1e-3, H = 0.4, PI = 3.14159265358979323846;

struct Reference {
    Eigen::Vector3d position;
    Eigen::Matrix3d rotation;
    Vector6 twist;
};

// One arm with its history, newest first in a ring of six states.
struct Arm {
    const pinocchio::Model& model;
    pinocchio::Data data;
    pinocchio::FrameIndex tip;
    std::vector<Reference> path;
    Vector7 q, velocity;
    std::vector<Vector7> states;
    Jacobian jacobian;
    int newest = 0, n = 0;

    Arm(const pinocchio::Model& model, pinocchio::FrameIndex tip, const Vector7& q0)
        : model(model), data(model), tip(tip), q(q0), states(6, q0) {
        pinocchio::framesForwardKinematics(model, data, q);
        const auto start = data.oMf[tip];
        for (int k = 0; k <= STEPS; ++k) {
            // A circle of 5 cm that begins at rest: u = sin^2(pi t / (2 T)).
            const double tau = double(k) / STEPS, s = std::sin(PI * tau / 2), u = s * s;
            const double rate = PI / 2 * std::sin(PI * tau) / (STEPS * SIGMA), angle = 2 * PI * u, r = 0.05;
            Reference reference;
            reference.position = start.translation() +
                                 Eigen::Vector3d(r * std::cos(angle) - r, r * std::sin(angle), 0);
            reference.rotation = start.rotation();
            reference.twist << -r * std::sin(angle) * 2 * PI * rate, r * std::cos(angle) * 2 * PI * rate, 0, 0, 0, 0;
            path.push_back(reference);
        }
    }

    void step() {
        pinocchio::computeJointJacobians(model, data, q);
        pinocchio::updateFramePlacement(model, data, tip);
        jacobian.setZero();
        pinocchio::getFrameJacobian(model, data, tip, pinocchio::LOCAL_WORLD_ALIGNED, jacobian);
        const Reference& wanted = path[n % STEPS];
        const auto& pose = data.oMf[tip];
        Vector6 error;
        error.head<3>() = pose.translation() - wanted.position;
        error.tail<3>() = pinocchio::log3(Eigen::Matrix3d(pose.rotation() * wanted.rotation.transpose()));
        // gamma sums to 2 in this row: h = sigma k gamma(1).
        const double gain = H / (SIGMA * 2.0);
        const Matrix6 gram = jacobian.lazyProduct(jacobian.transpose());
        const Eigen::LDLT<Matrix6> factor(gram);
        // Feedforward and feedback in one: nobody asks for them one by one here.
        const Vector6 solved = factor.solve(wanted.twist - gain * error);
        velocity.noalias() = jacobian.transpose() * solved;
        // The row solved for its newest state.
        const auto& at = [&](int age) -> const Vector7& { return states[(newest + age) % 6]; };
        newest = (newest + 5) % 6;
        Vector7& next = states[newest];
        next = (5.0 / 24) * at(1) + (12.0 / 24) * at(2) + (6.0 / 24) * at(3) + (4.0 / 24) * at(4) - (3.0 / 24) * at(5) +
               2.0 * SIGMA * velocity;
        q = next;
        ++n;
    }
};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4) return std::fprintf(stderr, "usage: pinocchio URDF NAME COUNT\n"), 2;
    const std::string name = argv[2];
    const int count = std::atoi(argv[3]);
    pinocchio::Model whole, model;
    pinocchio::urdf::buildModel(argv[1], whole);
    // Joints that do not move the tip are left out, as a chain leaves them out.
    const auto& path = whole.supports[whole.frames[whole.getFrameId("panda_link8")].parentJoint];
    std::vector<pinocchio::JointIndex> others;
    for (pinocchio::JointIndex joint = 1; joint < pinocchio::JointIndex(whole.njoints); ++joint)
        if (std::find(path.begin(), path.end(), joint) == path.end()) others.push_back(joint);
    pinocchio::buildReducedModel(whole, others, pinocchio::neutral(whole), model);
    const auto tip = model.getFrameId("panda_link8");
    Vector7 q;
    if (model.nq != 7) return std::fprintf(stderr, "expected an arm of 7 joints, found %d\n", model.nq), 1;
    q << 0.1, -0.4, 0.2, -2.1, 0.3, 1.8, 0.6;
    double sum = 0;
    if (name == "kinematics panda") {
        pinocchio::Data data(model);
        Jacobian jacobian;
        for (int i = 0; i < count; ++i) {
            q[0] += 1e-9;
            pinocchio::computeJointJacobians(model, data, q);
            pinocchio::updateFramePlacement(model, data, tip);
            jacobian.setZero();
            pinocchio::getFrameJacobian(model, data, tip, pinocchio::LOCAL_WORLD_ALIGNED, jacobian);
            sum += jacobian(0, 0) + data.oMf[tip].translation()[0];
        }
    } else if (name == "step 2 pandas") {
        Arm left(model, tip, q), right(model, tip, q);
        for (int i = 0; i < count; ++i) {
            if (left.n == STEPS) left.n = right.n = 0;
            left.step();
            right.step();
        }
        sum = left.q.sum() + right.q.sum();
    } else {
        return std::fprintf(stderr, "unknown work %s\n", name.c_str()), 2;
    }
    std::printf("%.17g\n", sum);
    return 0;
}
