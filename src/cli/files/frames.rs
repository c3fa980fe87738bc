//! `--frames DIR`: the simulated mesh over time as frame_0000.obj, frame_0001.obj ..., each written as it comes, whole
//! or not at all, so that a run can be watched and an interrupted one leaves what it had.

use crate::cli::files::input::name_of;
use crate::cli::files::output::Outputs;
use crease::io::write_frame_obj;
use crease::math::Vec3;
use crease::mesh::PointIndex;
use crease::{Error, Result};
use std::path::{Path, PathBuf};

/// Writes the frames of one run.
#[derive(Debug)]
pub struct FrameFolder<'a> {
    folder: PathBuf,
    /// Of the mesh that is simulated.
    triangles: Vec<[PointIndex; 3]>,
    /// Read by the run, and perhaps a frame of an earlier one: not to be written over.
    mesh: &'a Path,
    written: usize,
}

impl<'a> FrameFolder<'a> {
    /// Makes `folder` if there is none. No frame is written over `mesh`; `written` are there from a run that is taken
    /// up.
    pub fn new(folder: &Path, mesh: &'a Path, written: usize) -> Result<Self> {
        std::fs::create_dir_all(folder).map_err(|source| Error::File { file: name_of(folder), source })?;
        Ok(Self { folder: folder.to_owned(), triangles: Vec::new(), mesh, written })
    }

    /// Frames from now on are of a mesh of these triangles.
    pub fn show(&mut self, triangles: &[[PointIndex; 3]]) {
        self.triangles = triangles.to_vec();
    }

    /// Writes the next frame: `points` [m], one per point of the mesh.
    pub fn write(&mut self, points: &[Vec3]) -> Result<()> {
        let mut outputs = Outputs::new([self.mesh]);
        outputs.add(&self.path_of(self.written), &write_frame_obj(points, &self.triangles))?;
        outputs.commit()?;
        self.written += 1;
        Ok(())
    }

    /// A later frame that an earlier, longer run left here: it does not belong to these.
    pub fn left_over(&self) -> Option<PathBuf> {
        Some(self.path_of(self.written)).filter(|path| path.exists())
    }

    fn path_of(&self, number: usize) -> PathBuf {
        self.folder.join(format!("frame_{number:04}.obj"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_numbered_and_old_ones_noticed() {
        let folder = tempfile::tempdir().expect("a folder");
        let deep = folder.path().join("a/b");
        let mut frames = FrameFolder::new(&deep, Path::new("in.obj"), 0).expect("makes the folder");
        for x in [1.0, 2.0] {
            frames.write(&[Vec3::repeat(x)]).expect("writes");
        }
        let text = |name: &str| std::fs::read_to_string(deep.join(name)).expect("is there");
        assert_eq!(text("frame_0000.obj"), "v 1.0 1.0 1.0\n");
        assert_eq!(text("frame_0001.obj"), "v 2.0 2.0 2.0\n");
        assert_eq!(frames.left_over(), None);
        let shorter = FrameFolder { written: 1, ..frames };
        let second = deep.join("frame_0001.obj");
        assert_eq!(shorter.left_over(), Some(second.clone()));
        let mut over_input = FrameFolder { mesh: &second, ..shorter };
        assert!(over_input.write(&[]).expect_err("is refused").to_string().contains("would be overwritten"));
    }
}
