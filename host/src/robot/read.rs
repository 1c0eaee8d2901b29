//! A description of either kind, told by its root element.

use std::path::Path;

use super::xml::Xml;
use super::{Robot, RobotError, mjcf, urdf};

impl Robot {
    /// Reads the text of a URDF (`<robot>`) or an MJCF (`<mujoco>`). Nothing beside the text is opened: see [`Robot::read`].
    pub fn parse(text: &str) -> Result<Self, RobotError> {
        let xml = Xml::parse(text)?;
        let root = xml.document.root_element();
        let is_xacro = |namespace: &str| namespace.contains("xacro");
        if let Some(node) = root.descendants().find(|node| node.tag_name().namespace().is_some_and(is_xacro)) {
            return Err(RobotError::new(
                format!("line {}", xml.line(node)),
                format!("found <xacro:{}>, expected a URDF without macros", node.tag_name().name()),
                "expand it: xacro robot.urdf.xacro > robot.urdf",
            ));
        }
        match root.tag_name().name() {
            "robot" => urdf::read(&xml),
            "mujoco" => mjcf::read(&xml),
            other => Err(RobotError::new(
                format!("line {}", xml.line(root)),
                format!("found <{other}>, expected <robot> or <mujoco>"),
                "a URDF is one <robot> element with links and joints, an MJCF one <mujoco>; SDF can be converted to either",
            )),
        }
    }

    /// Reads a file, and the files beside it that an MJCF includes.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        let text = crate::files::read_text(path).map_err(|error| {
            RobotError::new("the file", format!("cannot be read: {error}"), "check the path; the file is text in UTF-8")
        });
        let read = |text: String| {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            Self::parse(&mjcf::included(text, folder)?)
        };
        text.and_then(read).map_err(|error| error.in_file(path))
    }
}
