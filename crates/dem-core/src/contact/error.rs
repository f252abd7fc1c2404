//! Why the parameters of a law were refused.

/// A parameter that no law can work with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LawError {
    /// A number that must be greater than zero is not (or is not finite).
    #[error("{law}: `{parameter}` is {value}, expected a finite number greater than 0")]
    NotPositive {
        /// Law or function that refused it.
        law: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// What was given.
        value: f64,
    },
    /// A number that must be zero or more is not (or is not finite).
    #[error("{law}: `{parameter}` is {value}, expected a finite number of at least 0")]
    Negative {
        /// Law or function that refused it.
        law: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// What was given.
        value: f64,
    },
    /// A number lies outside the range in which the law means something.
    #[error("{law}: `{parameter}` is {value}, expected {expected}")]
    OutOfRange {
        /// Law or function that refused it.
        law: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// What was given.
        value: f64,
        /// The range in words.
        expected: &'static str,
    },
    /// Two parameters contradict each other.
    #[error("{law}: `{first}` is {first_value} but `{second}` is {second_value}: {expected}")]
    Contradiction {
        /// Law or function that refused them.
        law: &'static str,
        /// Name of the first parameter.
        first: &'static str,
        /// What was given for the first.
        first_value: f64,
        /// Name of the second parameter.
        second: &'static str,
        /// What was given for the second.
        second_value: f64,
        /// What was expected, in words.
        expected: &'static str,
    },
}

/// `value` if it is finite and greater than zero.
pub(crate) fn positive(
    law: &'static str,
    parameter: &'static str,
    value: f64,
) -> Result<f64, LawError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(LawError::NotPositive { law, parameter, value })
    }
}

/// `value` if it is finite and at least zero.
pub(crate) fn non_negative(
    law: &'static str,
    parameter: &'static str,
    value: f64,
) -> Result<f64, LawError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(LawError::Negative { law, parameter, value })
    }
}

/// `value` if it is a coefficient of restitution that a dissipative law can reach.
pub(crate) fn restitution(law: &'static str, value: f64) -> Result<f64, LawError> {
    if value > 0.0 && value <= 1.0 {
        Ok(value)
    } else {
        Err(LawError::OutOfRange {
            law,
            parameter: "restitution",
            value,
            expected: "a number above 0 and at most 1",
        })
    }
}
