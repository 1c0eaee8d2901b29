//! Meshes of descriptions: STL, OBJ and COLLADA files.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use super::Solid;
use crate::files;
use crate::quietly::quietly;

/// Triangles of one file at most.
const MOST: usize = 4_000_000;

/// Finds and reads a mesh that a description in `folder` names; says why there is none.
pub(super) fn read(name: &str, scale: &Vector3<f64>, folder: &Path) -> Result<Vec<Solid>, String> {
    let path = find(name, folder).ok_or_else(|| format!("'{name}' is no file there"))?;
    let shown = path.display();
    let bytes = files::read(&path).map_err(|error| format!("{shown} cannot be read: {error}"))?;
    if bytes.starts_with(b"version https://git-lfs") {
        return Err(format!("{shown} is a pointer of Git LFS, not the mesh: run `git lfs pull` there"));
    }
    // The colours of an OBJ are in another file.
    let loader = mesh_loader::Loader::with_custom_reader(files::read);
    let loaded = quietly(|| loader.load_from_slice(&bytes, &path));
    let loaded = loaded.ok_or_else(|| format!("{shown} is damaged: it names what it does not have"))?;
    let scene = loaded.map_err(|error| match error.kind() {
        std::io::ErrorKind::Unsupported => format!("{shown} is no STL, OBJ or COLLADA file"),
        _ => format!("{shown} is damaged: {error}"),
    })?;
    let of = |at: usize| scene.materials.get(at).and_then(|material| material.color.diffuse);
    let mut solids = Vec::new();
    for (at, mesh) in scene.meshes.iter().enumerate() {
        let vertex = |vertex: &[f32; 3]| Vector3::from(vertex.map(f64::from)).component_mul(scale);
        let vertices: Vec<Vector3<f64>> = mesh.vertices.iter().map(vertex).collect();
        let triangles: Vec<[usize; 3]> = mesh.faces.iter().map(|face| face.map(|at| at as usize)).collect();
        let sound = vertices.iter().all(|vertex| vertex.iter().all(|x| x.abs() < 1e4))
            && triangles.as_flattened().iter().all(|at| *at < vertices.len());
        if !sound || triangles.len() > MOST {
            return Err(format!("{shown} is damaged: it has numbers that are no robot's"));
        }
        let flat = triangles.iter().all(|[a, b, c]| vertices[*a] == vertices[*b] || vertices[*b] == vertices[*c]);
        if flat {
            continue;
        }
        let colour = of(at).map(|[r, g, b, _]| [r, g, b].map(|x| f64::from(x).clamp(0.0, 1.0)));
        solids.push(Solid { vertices, triangles, colour });
    }
    if solids.is_empty() {
        return Err(format!("{shown} has no triangle of any size"));
    }
    Ok(solids)
}

/// Where a file is: as the name says, or, of a package, in a folder of the package's name or any other around the description.
fn find(name: &str, folder: &Path) -> Option<PathBuf> {
    if let Some(path) = name.strip_prefix("file://") {
        return Some(PathBuf::from(path)).filter(|path| path.is_file());
    }
    let Some(inside) = name.strip_prefix("package://").or(name.strip_prefix("model://")) else {
        return Some(folder.join(name)).filter(|path| path.is_file());
    };
    let package = Path::new(inside);
    let within: PathBuf = package.components().skip(1).collect();
    let around = folder.canonicalize().ok()?;
    around.ancestors().flat_map(|outer| [outer.join(package), outer.join(&within)]).find(|path| path.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1000 0 0\nvertex 0 500 0\nendloop\nendfacet\nendsolid a\n";

    #[test]
    fn a_mesh_is_found_by_path_and_by_package() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("desk_description/urdf");
        std::fs::create_dir_all(&deep).unwrap();
        std::fs::create_dir_all(folder.path().join("desk_description/meshes")).unwrap();
        std::fs::write(folder.path().join("desk_description/meshes/arm.STL"), STL).unwrap();
        let scale = Vector3::repeat(1e-3);
        for name in
            ["../meshes/arm.STL", "package://desk_description/meshes/arm.STL", "package://renamed/meshes/arm.STL"]
        {
            let solids = read(name, &scale, &deep).unwrap();
            assert_eq!(solids[0].triangles.len(), 1, "{name}");
            assert_eq!(solids[0].vertices[1], Vector3::new(1.0, 0.0, 0.0));
        }
        assert_eq!(read("arm.stl", &scale, &deep).unwrap_err(), "'arm.stl' is no file there");
        std::fs::write(deep.join("arm.step"), "ISO-10303-21;").unwrap();
        assert!(read("arm.step", &scale, &deep).unwrap_err().ends_with("is no STL, OBJ or COLLADA file"));
    }

    #[test]
    fn a_wavefront_and_a_collada_file_are_read_and_damaged_ones_say_so() {
        let folder = tempfile::tempdir().unwrap();
        let obj = "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
        std::fs::write(folder.path().join("a.obj"), obj).unwrap();
        let solids = read("a.obj", &Vector3::repeat(1.0), folder.path()).unwrap();
        assert_eq!(solids.iter().map(|solid| solid.triangles.len()).sum::<usize>(), 2);
        let dae = r##"<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="0.01"/><up_axis>Z_UP</up_axis></asset>
            <library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 100 0 0 0 200 0</float_array>
            <technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
            <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
            <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
            <library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
            <scene><instance_visual_scene url="#s"/></scene></COLLADA>"##;
        std::fs::write(folder.path().join("a.dae"), dae).unwrap();
        let solids = read("a.dae", &Vector3::repeat(1.0), folder.path()).unwrap();
        let far = solids[0].vertices.iter().map(|vertex| vertex.y).fold(0.0, f64::max);
        assert!((far - 2.0).abs() < 1e-6, "centimetres: {far}");
        for (name, text) in
            [("b.stl", "solid a\nfacet normal 0 0"), ("b.obj", "v 0 0 0\nf 1 2 9\n"), ("b.dae", "<COLLADA")]
        {
            std::fs::write(folder.path().join(name), text).unwrap();
            let error = read(name, &Vector3::repeat(1.0), folder.path());
            assert!(error.as_ref().is_err_and(|error| error.contains("is damaged")), "{name}: {error:?}");
        }
    }
}
