//! The memory law over arrays, for other simulators.

use crate::CreaseError;
use crate::convert::{list, numbers};
use crease::{ElementParams, HysteresisState, MemoryLaw};
use numpy::PyArray1;
use pyo3::prelude::*;

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
#[pyo3(signature = (state, before, after, duration, *, fabric = "kow-tshirt", kind = "angles", initial_rest = None, gain = None))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn advance_memory(
    state: &mut MemoryState,
    before: &Bound<'_, PyAny>,
    after: &Bound<'_, PyAny>,
    duration: f64,
    fabric: &str,
    kind: &str,
    initial_rest: Option<&Bound<'_, PyAny>>,
    gain: Option<&Bound<'_, PyAny>>,
) -> PyResult<(u64, u64)> {
    let memory = crate::convert::fabric(fabric)?.memory;
    let law = match kind {
        "angles" => MemoryLaw::for_angles(&memory),
        "lengths" => match MemoryLaw::for_lengths(&memory) {
            Some(law) => law,
            None => return Ok((0, 0)),
        },
        _ => return Err(CreaseError::new_err(format!("kind: {kind} is none of angles, lengths"))),
    };
    let count = state.elements.len();
    let of_elements =
        |value: Option<&Bound<'_, PyAny>>, name: &str, otherwise: Vec<f64>| -> PyResult<Vec<f64>> {
            let values = value.map_or(Ok(otherwise), |value| list(value, name))?;
            match values.len() {
                n if n == count => Ok(values),
                1 => Ok(vec![values[0]; count]),
                n => Err(CreaseError::new_err(format!("{name}: has {n} entries for {count} elements"))),
            }
        };
    let (from, to) =
        (of_elements(Some(before), "before", vec![])?, of_elements(Some(after), "after", vec![])?);
    let initial = of_elements(initial_rest, "initial_rest", state.initial.clone())?;
    let gain = of_elements(gain, "gain", vec![1.0; count])?;
    let mut events = (0, 0);
    for (k, element) in state.elements.iter_mut().enumerate() {
        let params = ElementParams { initial_rest: initial[k], gain: gain[k], mask: 1.0 };
        let new = law.advance(element, from[k], to[k], duration, &params);
        events = (events.0 + new.gradual, events.1 + new.critical);
    }
    Ok(events)
}
