//! A folder of frames of a run: the garment over time as frame_0000.obj, frame_0001.obj, ... Each frame is written as soon as it is due,
//! whole or not at all, so that a run can be watched and an interrupted run keeps its frames.

use crate::files::output::Outputs;
use crate::files::read::file_name;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_io::{FrameRow, FrameRows, write_frame_obj};
use crease_model::error::{Error, Result};
use std::path::{Path, PathBuf};

/// Writer of the frames of one run.
#[derive(Debug)]
pub struct FrameFolder {
    folder: PathBuf,
    /// Triangles of the frames.
    triangles: Vec<[PointIndex; 3]>,
    /// Rows of the frames; `None` where every point is one.
    rows: Option<Vec<FrameRow>>,
    /// Input mesh, which may be a frame of an earlier run and must not be overwritten; `None` for one that is no file.
    mesh: Option<PathBuf>,
    /// Frames written so far.
    written: usize,
}

impl FrameFolder {
    /// Creates `folder` if it is missing. `written` frames exist already if the run is resumed; `mesh` is never
    /// overwritten.
    pub fn new(folder: &Path, mesh: Option<PathBuf>, written: usize) -> Result<Self> {
        std::fs::create_dir_all(folder).map_err(|source| Error::File { file: file_name(folder), source })?;
        Ok(Self { folder: folder.to_owned(), triangles: Vec::new(), rows: None, mesh, written })
    }

    /// Shows the points of a mesh with `triangles` in the following frames.
    pub fn show_points(&mut self, triangles: &[[PointIndex; 3]]) {
        (self.triangles, self.rows) = (triangles.to_vec(), None);
    }

    /// Shows `rows` of the file in the following frames; `triangles` have the vertices of its worn pieces as corners.
    pub fn show_file(&mut self, rows: FrameRows, triangles: &[[u32; 3]]) {
        let row = |v: u32| PointIndex(rows.row_of_vertex.get(v as usize).copied().unwrap_or(v));
        self.triangles = triangles.iter().map(|t| t.map(row)).collect();
        self.rows = Some(rows.rows);
    }

    /// Writes the next frame; `points` has one position per point of the mesh [m].
    pub fn write(&mut self, points: &[Vec3]) -> Result<()> {
        let mut outputs = Outputs::new(self.mesh.as_deref());
        let text = match &self.rows {
            Some(rows) => {
                let position = |row: &FrameRow| match row {
                    FrameRow::Point(p) => points.get(p.at()).copied().unwrap_or_else(Vec3::zeros),
                    FrameRow::Fixed(x) => *x,
                };
                write_frame_obj(&rows.iter().map(position).collect::<Vec<_>>(), &self.triangles)
            }
            None => write_frame_obj(points, &self.triangles),
        };
        outputs.add(&self.path_of(self.written), &text)?;
        outputs.commit()?;
        self.written += 1;
        Ok(())
    }

    /// Returns the first frame that an earlier, longer run has left in the folder.
    pub fn stale_frame(&self) -> Option<PathBuf> {
        Some(self.path_of(self.written)).filter(|path| path.exists())
    }

    /// Returns the last frame that was written.
    pub fn last_frame(&self) -> Option<PathBuf> {
        self.written.checked_sub(1).map(|last| self.path_of(last))
    }

    fn path_of(&self, number: usize) -> PathBuf {
        self.folder.join(format!("frame_{number:04}.obj"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_numbered_and_stale_ones_detected() {
        let folder = tempfile::tempdir().expect("a folder");
        let deep = folder.path().join("a/b");
        let mut frames = FrameFolder::new(&deep, Some(PathBuf::from("in.obj")), 0).expect("makes the folder");
        for x in [1.0, 2.0] {
            frames.write(&[Vec3::repeat(x)]).expect("writes");
        }
        let text = |name: &str| std::fs::read_to_string(deep.join(name)).expect("is there");
        assert_eq!(text("frame_0000.obj"), "v 1.0 1.0 1.0\n");
        assert_eq!(text("frame_0001.obj"), "v 2.0 2.0 2.0\n");
        assert_eq!((frames.stale_frame(), frames.last_frame()), (None, Some(deep.join("frame_0001.obj"))));
        let shorter = FrameFolder { written: 1, ..frames };
        let second = deep.join("frame_0001.obj");
        assert_eq!(shorter.stale_frame(), Some(second.clone()));
        let mut over_input = FrameFolder { mesh: Some(second), ..shorter };
        assert!(over_input.write(&[]).expect_err("is refused").to_string().contains("would be overwritten"));
    }
}
