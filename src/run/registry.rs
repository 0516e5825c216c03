//! The methods this program knows: those of the package `stickslip-methods`, or what its `main` has installed instead.

use std::sync::OnceLock;

use stickslip_methods::{Method, Registry};

static REGISTRY: OnceLock<Registry> = OnceLock::new();

/// Makes these the methods of the program. False if others were asked for before: then they stay.
pub fn install(registry: Registry) -> bool {
    REGISTRY.set(registry).is_ok()
}

/// The registry; that of `stickslip-methods` unless another was installed.
pub fn registry() -> &'static Registry {
    REGISTRY.get_or_init(Registry::standard)
}

/// All methods, in the order of tables.
pub fn methods() -> &'static [&'static Method] {
    registry().methods()
}

/// The method of that name.
pub fn method(name: &str) -> Option<&'static Method> {
    registry().get(name)
}
