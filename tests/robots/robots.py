"""The robots that are derived and held against Pinocchio: file in example-robot-data, and whether the base floats."""

from __future__ import annotations

#: Name: (file, floating).  Arms, hands and torsos stand fixed; what walks has a floating base.
ROBOTS = {
    "UR5": ("ur_description/urdf/ur5_robot", False),
    "UR10": ("ur_description/urdf/ur10_robot", False),
    "Panda": ("panda_description/urdf/panda", False),
    "Kinova": ("kinova_description/robots/kinova", False),
    "xArm 7": ("xarm_description/urdf/xarm7", False),
    "Z1": ("z1_description/urdf/z1", False),
    "SO-101": ("so_arm_description/urdf/so101", False),
    "Talos arm": ("talos_data/robots/talos_left_arm", False),
    "Allegro hand": ("allegro_hand_description/urdf/allegro_right_hand", False),
    "Baxter": ("baxter_description/urdf/baxter", False),
    "Tiago without hand": ("tiago_description/robots/tiago_no_hand", False),
    "Tiago": ("tiago_description/robots/tiago", False),
    "Tiago Pro": ("tiago_pro_description/robots/tiago_pro", False),
    "Tiago Dual": ("tiago_description/robots/tiago_dual", False),
    "PR2": ("pr2_description/urdf/pr2", False),
    "Bolt": ("bolt_description/robots/bolt", True),
    "Solo 12": ("solo_description/robots/solo12", True),
    "A1": ("a1_description/urdf/a1", True),
    "Go2": ("go2_description/urdf/go2", True),
    "HyQ": ("hyq_description/robots/hyq_no_sensors", True),
    "ANYmal B": ("anymal_b_simple_description/robots/anymal", True),
    "ANYmal with Kinova": ("anymal_b_simple_description/robots/anymal-kinova", True),
    "iCub": ("icub_description/robots/icub", True),
    "Simple humanoid": ("simple_humanoid_description/urdf/simple_humanoid", True),
    "Romeo": ("romeo_description/urdf/romeo_small", True),
    "G1": ("g1_description/urdf/g1_29dof_rev_1_0", True),
    "Talos": ("talos_data/robots/talos_full_v2", True),
}

#: Tested in every run of the tests; ``make robots`` takes all.
QUICK = ("UR5", "Kinova", "Allegro hand", "ANYmal B")
