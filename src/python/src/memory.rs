//! The memory law over arrays, for other simulators.

use crate::CreaseError;
use crate::convert::{check_above_zero, check_not_negative, choice, exception, list, numbers};
use crease::internal::files::read_fabric;
use crease_model::fabric::Fabric;
use crease_solver::memory::{ElementParams, HysteresisState, MemoryLaw};
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

/// What the elements of a state are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Angles,
    Lengths,
}

impl Kind {
    /// Returns the law of `fabric`, if it has one.
    fn law(self, fabric: &Fabric) -> Option<MemoryLaw> {
        match self {
            Self::Angles => Some(MemoryLaw::for_angles(&fabric.memory)),
            Self::Lengths => MemoryLaw::for_lengths(&fabric.memory),
        }
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
    check_not_negative("duration", duration)?;
    let kind = choice("kind", kind, &[("angles", Kind::Angles), ("lengths", Kind::Lengths)])?;
    let fabric = read_fabric(&crate::convert::fabric(fabric)?).map_err(exception)?;
    let count = state.elements.len();
    let of_elements = |value: &Bound<'_, PyAny>, name: &str| -> PyResult<Vec<f64>> {
        let values = list(value, name)?;
        if kind == Kind::Lengths || name == "gain" {
            check_above_zero(name, &values)?;
        }
        match values.len() {
            n if n == count => Ok(values),
            1 => Ok(vec![values[0]; count]),
            n => Err(CreaseError::new_err(format!(
                "{name}: has {n} entries for the {count} elements of the state (give one for all, or one for each)"
            ))),
        }
    };
    let (from, to) = (of_elements(before, "before")?, of_elements(after, "after")?);
    let initial = initial_rest.map(|value| of_elements(value, "initial_rest")).transpose()?;
    let gain = gain.map(|value| of_elements(value, "gain")).transpose()?;
    if kind == Kind::Lengths {
        check_above_zero("state.rest", &state.initial)?;
    }
    // A fabric may keep no change of lengths.
    let Some(law) = kind.law(&fabric) else { return Ok((0, 0)) };
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
