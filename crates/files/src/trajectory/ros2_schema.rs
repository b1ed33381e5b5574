//! Definitions of the messages that are written, from the public interface packages of ROS 2.

use std::fmt::Write;

/// Each message with its fields.
const DEFINITIONS: &[(&str, &str)] = &[
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"),
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
    ("std_msgs/String", "string data\n"),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Point32", "float32 x\nfloat32 y\nfloat32 z\n"),
    ("geometry_msgs/Polygon", "geometry_msgs/Point32[] points\n"),
    ("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"),
    ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"),
    (
        "geometry_msgs/TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
    ),
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"),
    ("geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"),
    ("geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"),
    ("geometry_msgs/Wrench", "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n"),
    ("tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"),
    ("nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"),
    (
        "sensor_msgs/JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    ),
    (
        "sensor_msgs/MultiDOFJointState",
        "std_msgs/Header header\nstring[] joint_names\ngeometry_msgs/Transform[] transforms\n\
         geometry_msgs/Twist[] twist\ngeometry_msgs/Wrench[] wrench\n",
    ),
    (
        "trajectory_msgs/JointTrajectoryPoint",
        "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\n\
         builtin_interfaces/Duration time_from_start\n",
    ),
    (
        "trajectory_msgs/JointTrajectory",
        "std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/JointTrajectoryPoint[] points\n",
    ),
    (
        "trajectory_msgs/MultiDOFJointTrajectoryPoint",
        "geometry_msgs/Transform[] transforms\ngeometry_msgs/Twist[] velocities\n\
         geometry_msgs/Twist[] accelerations\nbuiltin_interfaces/Duration time_from_start\n",
    ),
    (
        "trajectory_msgs/MultiDOFJointTrajectory",
        "std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/MultiDOFJointTrajectoryPoint[] points\n",
    ),
    ("object_recognition_msgs/ObjectType", "string key\nstring db\n"),
    ("shape_msgs/SolidPrimitive", "uint8 type\nfloat64[<=3] dimensions\ngeometry_msgs/Polygon polygon\n"),
    ("shape_msgs/MeshTriangle", "uint32[3] vertex_indices\n"),
    ("shape_msgs/Mesh", "shape_msgs/MeshTriangle[] triangles\ngeometry_msgs/Point[] vertices\n"),
    ("shape_msgs/Plane", "float64[4] coef\n"),
    (
        "moveit_msgs/CollisionObject",
        "std_msgs/Header header\ngeometry_msgs/Pose pose\nstring id\nobject_recognition_msgs/ObjectType type\n\
         shape_msgs/SolidPrimitive[] primitives\ngeometry_msgs/Pose[] primitive_poses\nshape_msgs/Mesh[] meshes\n\
         geometry_msgs/Pose[] mesh_poses\nshape_msgs/Plane[] planes\ngeometry_msgs/Pose[] plane_poses\n\
         string[] subframe_names\ngeometry_msgs/Pose[] subframe_poses\nbyte operation\n",
    ),
    (
        "moveit_msgs/AttachedCollisionObject",
        "string link_name\nmoveit_msgs/CollisionObject object\nstring[] touch_links\n\
         trajectory_msgs/JointTrajectory detach_posture\nfloat64 weight\n",
    ),
    (
        "moveit_msgs/RobotState",
        "sensor_msgs/JointState joint_state\nsensor_msgs/MultiDOFJointState multi_dof_joint_state\n\
         moveit_msgs/AttachedCollisionObject[] attached_collision_objects\nbool is_diff\n",
    ),
    (
        "moveit_msgs/RobotTrajectory",
        "trajectory_msgs/JointTrajectory joint_trajectory\n\
         trajectory_msgs/MultiDOFJointTrajectory multi_dof_joint_trajectory\n",
    ),
    (
        "moveit_msgs/DisplayTrajectory",
        "string model_id\nmoveit_msgs/RobotTrajectory[] trajectory\nmoveit_msgs/RobotState trajectory_start\n",
    ),
];

/// Returns the text of a schema `package/Message`: its own fields, and behind lines of `=` those of every message in it.
pub(super) fn schema(name: &str) -> String {
    let mut names = vec![name.to_owned()];
    let mut text = fields(name).to_owned();
    let mut next = 0;
    while next < names.len() {
        let inner: Vec<String> = parts(fields(&names[next])).map(str::to_owned).collect();
        for part in inner {
            if !names.contains(&part) {
                // Writing to a String can not fail.
                let _ = write!(text, "{}\nMSG: {part}\n{}", "=".repeat(80), fields(&part));
                names.push(part);
            }
        }
        next += 1;
    }
    text
}

fn fields(name: &str) -> &'static str {
    DEFINITIONS.iter().find(|(known, _)| *known == name).map_or("", |(_, fields)| fields)
}

/// The messages that are fields of a message.
fn parts(fields: &str) -> impl Iterator<Item = &str> {
    let kinds = fields.lines().filter_map(|line| line.split([' ', '[']).next());
    kinds.filter(|kind| kind.contains('/'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_message_within_a_message_is_defined_once() {
        for (name, fields_of_it) in DEFINITIONS {
            assert!(parts(fields_of_it).all(|part| !fields(part).is_empty()), "{name}");
            let text = schema(name);
            let mut defined: Vec<&str> = text.lines().filter(|line| line.starts_with("MSG: ")).collect();
            let count = defined.len();
            defined.sort_unstable();
            defined.dedup();
            assert_eq!(defined.len(), count, "{name}");
        }
        assert!(schema("tf2_msgs/TFMessage").contains("MSG: geometry_msgs/Quaternion"));
    }
}
