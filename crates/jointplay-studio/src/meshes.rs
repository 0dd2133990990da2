//! Mesh files named in the robot file, read from its folder only.

use std::path::{Path, PathBuf};

use jointplay::format::robot::{self, Mesh, MeshFormat, Robot};

/// Maximum size of a mesh file (bytes).
const MAX_BYTES: u64 = 50_000_000;

/// The folder of the robot file.
#[derive(Clone)]
pub(crate) struct MeshFolder(Option<PathBuf>);

impl MeshFolder {
    /// The folder of a robot file; checks that all mesh files of the robot exist.
    pub(crate) fn of(folder: Option<&Path>, robot: &Robot) -> Result<Self, robot::Error> {
        let folder = Self(folder.map(Path::to_owned));
        for mesh in [&robot.base_mesh, &robot.platform_mesh].into_iter().flatten() {
            folder.find(mesh)?;
        }
        Ok(folder)
    }

    /// Checks that a mesh file can be read.
    fn find(&self, mesh: &Mesh) -> Result<(), robot::Error> {
        let found = jointplay_files::find(self.folder_for(mesh)?, &mesh.path, MAX_BYTES);
        found.map(drop).map_err(|why| mesh.unreadable(why.to_string()))
    }

    /// Contents of a mesh file; refused if it has grown beyond the limit since it was found.
    pub(crate) fn read(&self, mesh: &Mesh) -> Result<Vec<u8>, robot::Error> {
        let read = jointplay_files::read(self.folder_for(mesh)?, &mesh.path, MAX_BYTES);
        read.map_err(|why| mesh.unreadable(why.to_string()))
    }

    /// The folder of the robot file, which has the file of a mesh.
    fn folder_for(&self, mesh: &Mesh) -> Result<&Path, robot::Error> {
        let folder = self.0.as_deref();
        folder.ok_or_else(|| mesh.unreadable("the robot was not read from a file".to_owned()))
    }
}

/// Media type of a mesh format.
pub(crate) fn media_type(format: MeshFormat) -> &'static str {
    match format {
        MeshFormat::Stl => "model/stl",
        MeshFormat::Obj => "model/obj",
        MeshFormat::Gltf => "model/gltf+json",
        MeshFormat::Glb => "model/gltf-binary",
    }
}
