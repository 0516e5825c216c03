//! Enums whose variants have names in files and tables: declared with them, so that no list or match can lack one.

/// Declares such an enum with `ALL`, `name` and `Display`.
macro_rules! named {
    ($(#[$about:meta])* $of:vis enum $Enum:ident {
        $($(#[$meaning:meta])* $Variant:ident = $name:literal,)*
    }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        $of enum $Enum { $($(#[$meaning])* $Variant,)* }

        impl $Enum {
            /// All, in the order of their declaration.
            pub const ALL: &'static [Self] = &[$(Self::$Variant),*];

            /// Name in files and tables.
            pub fn name(self) -> &'static str {
                match self { $(Self::$Variant => $name,)* }
            }
        }

        impl std::fmt::Display for $Enum {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}
pub(crate) use named;
