//! `<geom>`: how bodies look, as far as MuJoCo's own viewer shows it at first: groups 0 to 2.

use std::collections::HashMap;
use std::path::Path;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::super::RobotError;
use super::super::shape::{Form, Shape};
use super::defaults::Defaults;
use super::pose::Angles;
use super::source::Source;

/// The last group that is shown.
const SHOWN: f64 = 2.0;

/// Attributes of a geom that are read.
const ATTRIBUTES: [&str; 7] = ["type", "size", "fromto", "mesh", "rgba", "material", "group"];

/// What geoms refer to.
pub(super) struct Geoms {
    defaults: Defaults,
    /// File and scale of each mesh.
    meshes: HashMap<String, (String, Vector3<f64>)>,
    materials: HashMap<String, [f64; 3]>,
}

impl Geoms {
    /// Reads `<asset>`; a mesh lies in the folder that `<compiler>` names. What is damaged there has no colour and no scale: a robot moves
    /// without.
    pub fn read(source: &Source) -> Result<Self, RobotError> {
        let scales = Defaults::read(source, "mesh", &["scale"])?;
        let compiler = source.sections("compiler");
        let says = |name| compiler.iter().rev().find_map(|at| source.get(*at, name));
        let folder = says("meshdir").or(says("assetdir")).unwrap_or_default();
        let bare = says("strippath") == Some("true");
        let (mut meshes, mut materials) = (HashMap::new(), HashMap::new());
        for section in source.sections("asset") {
            for at in source.children(section, "mesh") {
                let Some(file) = source.get(at, "file") else { continue };
                let path = Path::new(file);
                let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                let name = source.get(at, "name").map_or(stem, str::to_owned);
                let scale = scales.says(source, at, None, "scale").ok().flatten();
                let scale = scale.and_then(|from| source.vector(from, "scale").ok());
                let path = if bare { Path::new(path.file_name().unwrap_or_default()) } else { path };
                let file = Path::new(folder).join(path).to_string_lossy().into_owned();
                meshes.insert(name, (file, scale.unwrap_or_else(|| Vector3::repeat(1.0))));
            }
            for at in source.children(section, "material") {
                if let (Some(name), Ok(Some(colour))) = (source.get(at, "name"), colour(source, at)) {
                    materials.insert(name.to_owned(), colour);
                }
            }
        }
        Ok(Self { defaults: Defaults::read(source, "geom", &ATTRIBUTES)?, meshes, materials })
    }

    /// The shape of a geom in its body's frame, of a link yet without name; none where the viewer shows none.
    pub fn shape(
        &self,
        source: &Source,
        angles: &Angles,
        at: usize,
        class: Option<&str>,
        frame: &Isometry3<f64>,
    ) -> Result<Option<Shape>, RobotError> {
        let says = |name: &str| self.defaults.says(source, at, class, name);
        let text = |name: &str| Ok::<_, RobotError>(says(name)?.and_then(|from| source.get(from, name)));
        let group = says("group")?.map(|from| source.exactly::<1>(from, "group")).transpose()?.flatten();
        if group.is_some_and(|[group]| group > SHOWN) {
            return Ok(None);
        }
        let refuse = |what: String| RobotError::new(source.place(at), what, "correct it");
        let mut place = *frame * angles.pose(source, at)?;
        let size = says("size")?.map(|from| source.numbers(from, "size")).transpose()?.flatten().unwrap_or_default();
        let mesh = text("mesh")?;
        let kind = text("type")?.unwrap_or(if mesh.is_some() { "mesh" } else { "sphere" });
        let ends = says("fromto")?.map(|from| source.exactly::<6>(from, "fromto")).transpose()?.flatten();
        // Radius or half widths, then half of the length.
        let mut length = |index: usize| match ends {
            Some([a, b, c, d, e, f]) => {
                let (from, to) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
                let half_turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
                let turn = UnitQuaternion::rotation_between(&Vector3::z(), &(to - from)).unwrap_or(half_turn);
                place = *frame * Isometry3::from_parts(Translation3::from(from.lerp(&to, 0.5)), turn);
                Some((to - from).norm() / 2.0)
            }
            None => size.get(index).copied(),
        };
        let form = match (kind, size.first()) {
            ("plane" | "hfield" | "sdf", _) => return Ok(None),
            ("mesh", _) => {
                let name = mesh.unwrap_or_default();
                let known =
                    self.meshes.get(name).ok_or_else(|| refuse(format!("its mesh '{name}' is not in <asset>")))?;
                Some(Form::Mesh(known.0.clone(), known.1))
            }
            ("sphere", Some(radius)) => Some(Form::Ellipsoid(Vector3::repeat(*radius))),
            ("capsule", Some(radius)) => length(1).map(|half| Form::Capsule(*radius, 2.0 * half)),
            ("cylinder", Some(radius)) => length(1).map(|half| Form::Cylinder(*radius, 2.0 * half)),
            ("box" | "ellipsoid", Some(x)) => {
                let y = size.get(1).copied().filter(|_| ends.is_none()).or(ends.map(|_| *x));
                let half = y.zip(length(2)).map(|(y, z)| Vector3::new(*x, y, z));
                half.map(|half| if kind == "box" { Form::Cuboid(2.0 * half) } else { Form::Ellipsoid(half) })
            }
            _ => None,
        };
        let form = form.ok_or_else(|| refuse(format!("found type=\"{kind}\" with {} sizes", size.len())))?;
        if size.iter().any(|x| *x < 0.0) {
            return Err(refuse("size: found a length below 0".to_owned()));
        }
        let own = says("rgba")?.map(|from| colour(source, from)).transpose()?.flatten();
        let colour = own.or(text("material")?.and_then(|name| self.materials.get(name).copied()));
        Ok(Some(Shape { link: String::new(), at: place, form, colour }))
    }
}

fn colour(source: &Source, at: usize) -> Result<Option<[f64; 3]>, RobotError> {
    let rgba = source.numbers(at, "rgba")?;
    Ok(rgba.and_then(|rgba| rgba.first_chunk::<3>().copied()).map(|rgb| rgb.map(|x| x.clamp(0.0, 1.0))))
}
