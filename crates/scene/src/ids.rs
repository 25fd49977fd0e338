//! Ids: the path of the prim that the host speaks of, one type a kind of prim.
//!
//! A path names the same prim before it is defined, after it is removed, and in every warning.

use std::fmt;
use std::sync::Arc;

macro_rules! path_id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(Arc<str>);

        impl $name {
            /// The id of the prim at `path`.
            pub fn new(path: &str) -> Self {
                Self(path.into())
            }
            /// The prim's path.
            pub fn path(&self) -> &str {
                &self.0
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.0)
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!(stringify!($name), "({})"), self.0)
            }
        }
    };
}

path_id! {
    /// A mesh.
    MeshId
}
path_id! {
    /// An instancer: of points, or of a native-instancing prototype.
    InstancerId
}
path_id! {
    /// A camera.
    CameraId
}
path_id! {
    /// A light.
    LightId
}
path_id! {
    /// A material.
    MaterialId
}
path_id! {
    /// A category of light linking: what the host calls the collection of a light's, or of several that have the same
    /// members. Light and shadow links name one; what belongs to it carries it.
    Category
}
