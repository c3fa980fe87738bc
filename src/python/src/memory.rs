//! The memory law over arrays, for other simulators.

use crate::CreaseError;
use crate::convert::{list, numbers};
use crease::{ElementParams, Fabric, HysteresisState, MemoryLaw};
use numpy::PyArray1;
use pyo3::prelude::*;

/// Memory of hinges or lengths: new cloth with these rest angles [rad] or stretches.
#[pyclass(module = "crease")]
pub struct MemoryState {
    elements: Vec<HysteresisState>,
    initial: Vec<f64>,
}

#[pymethods]
impl MemoryState {
    #[new]
    fn new(rest: &Bound<'_, PyAny>) -> PyResult<Self> {
        let initial = list(rest, "rest")?;
        Ok(Self { elements: initial.iter().map(|&rest| HysteresisState::new(rest)).collect(), initial })
    }

    fn __len__(&self) -> usize {
        self.elements.len()
    }

    fn __repr__(&self) -> String {
        format!("MemoryState({} elements)", self.elements.len())
    }

    #[getter]
    fn rest<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.elements.iter().map(|element| element.rest).collect::<Vec<_>>())
    }

    #[getter]
    fn stiffness_ratio<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.elements.iter().map(|element| element.stiffness_ratio).collect::<Vec<_>>())
    }
}

/// Advances `state` over a step; returns the numbers of gradual and critical events.
#[pyfunction]
#[pyo3(signature = (state, before, after, duration, *, fabric = None, kind = "angles", initial_rest = None, gain = None))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn advance_memory(
    py: Python<'_>,
    state: &mut MemoryState,
    before: &Bound<'_, PyAny>,
    after: &Bound<'_, PyAny>,
    duration: f64,
    fabric: Option<&Bound<'_, PyAny>>,
    kind: &str,
    initial_rest: Option<&Bound<'_, PyAny>>,
    gain: Option<&Bound<'_, PyAny>>,
) -> PyResult<(u64, u64)> {
    if !(duration >= 0.0 && duration.is_finite()) {
        return Err(CreaseError::new_err(format!("duration: {duration} is no number of at least 0")));
    }
    let law = law(&crate::convert::fabric(fabric)?, kind)?;
    let count = state.elements.len();
    let of_elements = |value: &Bound<'_, PyAny>, name: &str| -> PyResult<Vec<f64>> {
        let values = list(value, name)?;
        match values.len() {
            n if n == count => Ok(values),
            1 => Ok(vec![values[0]; count]),
            n => Err(CreaseError::new_err(format!("{name}: has {n} entries for {count} elements"))),
        }
    };
    let (from, to) = (of_elements(before, "before")?, of_elements(after, "after")?);
    let initial = initial_rest.map(|value| of_elements(value, "initial_rest")).transpose()?;
    let gain = gain.map(|value| of_elements(value, "gain")).transpose()?;
    let Some(law) = law else { return Ok((0, 0)) };
    let MemoryState { elements, initial: own } = state;
    let initial = initial.as_ref().unwrap_or(own);
    Ok(py.detach(|| {
        let mut events = (0, 0);
        for (k, element) in elements.iter_mut().enumerate() {
            let gain = gain.as_ref().map_or(1.0, |gain| gain[k]);
            let params = ElementParams { initial_rest: initial[k], gain, mask: 1.0 };
            let new = law.advance(element, from[k], to[k], duration, &params);
            events = (events.0 + new.gradual, events.1 + new.critical);
        }
        events
    }))
}

/// Returns the law of `kind`; `None` where the fabric keeps no change of lengths.
fn law(fabric: &Fabric, kind: &str) -> PyResult<Option<MemoryLaw>> {
    match kind {
        "angles" => Ok(Some(MemoryLaw::for_angles(&fabric.memory))),
        "lengths" => Ok(MemoryLaw::for_lengths(&fabric.memory)),
        _ => Err(CreaseError::new_err(format!("kind: {kind} is none of angles, lengths"))),
    }
}
