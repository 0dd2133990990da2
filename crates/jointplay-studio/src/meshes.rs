//! Shapes named in the robot file, from its folder and from nowhere else.

use std::path::{Path, PathBuf};

use jointplay::format::robot::{self, Mesh, MeshFormat, Robot};

/// The largest shape that is served [bytes].
const LARGEST: u64 = 50_000_000;

/// The folder of the robot file, where shapes are.
#[derive(Clone)]
pub(crate) struct MeshFolder(Option<PathBuf>);

impl MeshFolder {
    /// The folder of a robot file, with every shape that the file names in it.
    pub(crate) fn of(folder: Option<&Path>, robot: &Robot) -> Result<Self, robot::Error> {
        let folder = Self(folder.map(Path::to_owned));
        for mesh in [&robot.base_mesh, &robot.platform_mesh].into_iter().flatten() {
            folder.find(mesh)?;
        }
        Ok(folder)
    }

    /// Where a shape really is.
    fn find(&self, mesh: &Mesh) -> Result<PathBuf, robot::Error> {
        let folder = self.0.as_deref();
        let folder =
            folder.ok_or_else(|| mesh.unreadable("the robot is not from a file".to_owned()))?;
        let found = jointplay_files::find(folder, &mesh.path, LARGEST);
        found.map_err(|why| mesh.unreadable(why.to_string()))
    }

    /// The bytes of a shape.
    pub(crate) fn read(&self, mesh: &Mesh) -> Result<Vec<u8>, robot::Error> {
        std::fs::read(self.find(mesh)?).map_err(|error| mesh.unreadable(error.to_string()))
    }
}

/// The media type of a shape.
pub(crate) fn media_type(format: MeshFormat) -> &'static str {
    match format {
        MeshFormat::Stl => "model/stl",
        MeshFormat::Obj => "model/obj",
        MeshFormat::Gltf => "model/gltf+json",
        MeshFormat::Glb => "model/gltf-binary",
    }
}
