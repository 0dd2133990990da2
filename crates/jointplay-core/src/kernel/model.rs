//! The virtualizations of this crate, as the kernels know them.

/// One of the virtualizations of this crate, as a kernel knows it.
///
/// Every socket has a coordinate `a` that moves it along a direction, and all but [`Radial`] a coordinate `b` that moves it across.
pub(crate) trait Model: Copy {
    /// Whether there is a coordinate `b`.
    const ACROSS: bool;
    /// Whether `b` is an angle, which turns the direction.
    const TURNS: bool;
    /// Whether coordinates count from the nominal socket, or from O_p.
    const FROM_SOCKET: bool;
    /// Whether directions are those toward the sockets, or e_p1.
    const TOWARD_SOCKET: bool;
    /// Whether a closed form may exist: for radial coordinates where the sockets are 120° apart.
    const CLOSED_FORM: bool = !Self::TOWARD_SOCKET || !Self::ACROSS;
    /// Whether the least displacement is found to round-off, so that polynomials can replace the iteration.
    const SETTLES: bool = !(Self::TURNS && Self::FROM_SOCKET);
    /// Whether coordinates are polar: angles turn the sockets about O_p.
    const AROUND_CENTER: bool = Self::TURNS && !Self::FROM_SOCKET;
}

macro_rules! models {
    ($($module:ident $name:ident: $across:literal, $turns:literal, $from_socket:literal, $toward_socket:literal;)*) => {$(
        pub(crate) use $module::$name;

        mod $module {
            #[derive(Clone, Copy)]
            pub(crate) struct $name;

            impl super::Model for $name {
                const ACROSS: bool = $across;
                const TURNS: bool = $turns;
                const FROM_SOCKET: bool = $from_socket;
                const TOWARD_SOCKET: bool = $toward_socket;
            }
        }
    )*};
}

// Each in a module of its own, with which its kernels are compiled, side by side with those of the others.
// across, turns, from socket, toward socket
models! {
    radial Radial: false, false, false, true;
    polar Polar: true, true, false, true;
    offset Offset: true, true, true, true;
    planar Planar: true, false, true, false;
}
