"""Compiled core of the predictive controllers: node kernel and stagewise SQP for serial chains of 1 to 8 joints.

State x = (q, v, e): joint positions [rad | m], velocities [rad/s | m/s] and, by kind,
e = contact force in contact axes [N, N·m] ('force_feedback'), e = joint torque [N·m] ('torque_feedback'), else nothing.
Control u = joint torque [N·m]; in 'torque_feedback' the unfiltered torque w. Forces are the environment's reaction on
the robot. Cost of a horizon: J = Σ_k dt · ½ Σ w r² + ½ Σ w_N r_N²; weights are the squared activation times the scalar
weight, per component, and the terminal node's are not multiplied by dt. Wrong values raise ValueError (one sentence:
rule, what was got).
"""

from collections.abc import Mapping, Sequence
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant._loop import Part

Kind: TypeAlias = Literal["force_feedback", "classical", "torque_feedback", "free", "naive_viscoelastic"]
Axes: TypeAlias = Literal["local", "world", "surface"]
Status: TypeAlias = Literal[
    "converged",  # KKT residual at or below the tolerance
    "max_iterations",  # the last iterate is returned, its residual is `kkt`
    "time_budget",  # likewise, the budget was used up
    "line_search",  # no step was accepted by the filter
    "not_positive_definite",  # the recursion broke down even with the largest regularisation
    "nan",  # a value that is not finite, in the input or on the way; xs and us are the last finite iterate
]

MAX_JOINTS: int  # 8

class Chain:
    """A serial chain: fixed base, every joint actuated, any fixed transform between joints."""

    def __init__(
        self,
        rotations: ArrayLike,
        translations: ArrayLike,
        joint_types: Sequence[Literal["revolute", "prismatic"]],
        axes: ArrayLike,
        masses: ArrayLike,
        coms: ArrayLike,
        inertias: ArrayLike,
        *,
        rotor_inertia: ArrayLike | None = None,
        joint_damping: ArrayLike | None = None,
        gravity: ArrayLike = (0.0, 0.0, -9.81),
        tool_rotation: ArrayLike | None = None,
        tool_translation: ArrayLike | None = None,
        contact_rotation: ArrayLike | None = None,
        contact_translation: ArrayLike | None = None,
    ) -> None:
        """Describe the chain.

        Args:
            rotations: (n, 3, 3) R of joint i's frame in its parent link's frame (world for i = 0), at zero.
            translations: (n, 3) [m] origin of joint i's frame in its parent link's frame.
            joint_types: n names; "revolute" turns about, "prismatic" slides along its axis.
            axes: (n, 3) unit axis in the joint's frame.
            masses: (n,) [kg].
            coms: (n, 3) [m] centre of mass in the link's frame.
            inertias: (n, 3, 3) [kg m²] about the centre of mass, in the link's axes (pinocchio's `Inertia.inertia`).
            rotor_inertia: (n,) [kg m² | kg] reflected to the joint, added to the diagonal of M; zero if None.
            joint_damping: (n,) [N·m·s/rad | N·s/m] viscous torque −d v; zero if None.
            gravity: (3,) [m/s²] in world axes.
            tool_rotation: (3, 3) frame of the placement costs in the last link's frame; identity if None.
            tool_translation: (3,) [m] likewise; zero if None.
            contact_rotation: (3, 3) frame of the contact in the last link's frame; the tool's if None.
            contact_translation: (3,) [m] likewise.

        Raises:
            ValueError: n outside 1..8, wrong shapes, a rotation that is not one, an axis not of length 1, a negative
                mass, a value that is not finite.
        """
    @property
    def dof(self) -> int: ...
    def mass_matrix(self, q: ArrayLike) -> NDArray[np.float64]:
        """(n, n) M(q) with the rotor inertia on its diagonal."""
    def contact_placement(self, q: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(R (3, 3), p (3,) [m]) of the contact frame in the world."""
    def tool_placement(self, q: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(R (3, 3), p (3,) [m]) of the tool frame in the world."""

class Model:
    """Which of the predictive models, and its constants."""

    def __init__(
        self,
        kind: Kind,
        contact_dim: int,
        axes: Axes = "world",
        *,
        torque_bandwidth: float = 50.0,
        baumgarte: tuple[float, float] = (0.0, 0.0),
        integrator: Literal["euler", "exponential"] = "euler",
    ) -> None:
        """Choose the model.

        Args:
            kind: [FFMPC] sections V-C, III-C, IV-C, no contact, V-B.
            contact_dim: 1 (force along the third contact axis), 3 (force), 6 (force, moment); 0 with kind 'free' only.
            axes: contact axes: 'local' turn with the contact frame, 'world' are aligned with the world, 'surface' are
                the columns of each node's `task_rotation`.
            torque_bandwidth: [Hz] f_c of 'torque_feedback': α = exp(−2π f_c dt).
            baumgarte: (kp [1/s²], kd [1/s]) of the rigid contact: d(Jv)/dt + kd Jv + kp e = 0.
            integrator: of the force state in 'force_feedback': 'euler' is [FFMPC] eq. 24; 'exponential' is exact for
                frozen task inertia (K up to 1e5 N/m at 3 ms).

        Raises:
            ValueError: an unknown name (lists the valid ones), a dimension that does not fit the kind, a non-rotation,
                a bandwidth not positive.
        """
    @property
    def kind(self) -> Kind: ...
    @property
    def contact_dim(self) -> int: ...
    @property
    def axes(self) -> Axes: ...
    @property
    def integrator(self) -> Literal["euler", "exponential"]: ...
    def state_dim(self, dof: int) -> int:
        """nx: 2n, + contact_dim in force feedback, + n in torque feedback."""

class Nodes:
    """Parameters of M nodes. Every attribute is a *writable view* whose first axis is the node (rows roll with slices).

    Assign into it (`nodes.force_reference[k:] = 20.0`) or to it (`nodes.force_reference = 20.0`, broadcast); an unknown
    name raises AttributeError. Values are checked at the next evaluation. Last row = terminal node: it counts state,
    translation, rotation and velocity terms, and in force feedback the force term and the force bounds.
    n = dof, m = contact_dim.
    """

    def __init__(self, count: int, chain: Chain, model: Model) -> None:
        """Nodes without costs or bounds, by themselves; those of a solver or a node belong to it."""
    @property
    def count(self) -> int: ...
    state_reference: NDArray[np.float64]  # (M, 2n) [rad, rad/s]
    state_weight: NDArray[np.float64]  # (M, 2n)
    control_reference: NDArray[np.float64]  # (M, n) [N·m]
    control_weight: NDArray[np.float64]  # (M, n) on u − reference
    torque_gravity_weight: NDArray[np.float64]  # (M, n) on τ − (g(q) − Jᵀλ); τ = u, or the state τ in torque feedback
    control_gravity_weight: NDArray[np.float64]  # (M, n) on w − (g(q) − Jᵀλ), torque feedback only (eq. 28)
    task_rotation: NDArray[np.float64]  # (M, 3, 3) R_world_task: axes of translation and velocity costs; with axes
    # 'surface' of the contact too, the third column being the outward normal
    translation_reference: NDArray[np.float64]  # (M, 3) [m] tool frame in the world
    translation_weight: NDArray[np.float64]  # (M, 3) task axes
    rotation_reference: NDArray[np.float64]  # (M, 3, 3) R_world_tool
    rotation_weight: NDArray[np.float64]  # (M, 3) on log(R_refᵀ R)
    velocity_reference: NDArray[np.float64]  # (M, 6) [m/s, rad/s] tool frame, LOCAL_WORLD_ALIGNED
    velocity_weight: NDArray[np.float64]  # (M, 6) task axes
    force_reference: NDArray[np.float64]  # (M, m) [N, N·m] contact axes
    force_weight: NDArray[np.float64]  # (M, m)
    force_rate_weight: NDArray[np.float64]  # (M, m) on λ̇, force feedback only
    stiffness: NDArray[np.float64]  # (M, m) K [N/m, N·m/rad]; with the Euler integrator K dt < B
    damping: NDArray[np.float64]  # (M, m) B [N·s/m, N·m·s/rad]
    anchor_translation: NDArray[
        np.float64
    ]  # (M, 3) [m] contact at rest: spring of 'naive_viscoelastic', kp of Baumgarte
    anchor_rotation: NDArray[np.float64]  # (M, 3, 3) likewise, dimension 6
    contact_active: NDArray[np.bool_]  # (M,) off: no force on the robot, λ̇ = 0, no force costs or bounds
    torque_lower: NDArray[np.float64]  # (M, n) [N·m], −inf: no bound; on u
    torque_upper: NDArray[np.float64]  # (M, n)
    force_lower: NDArray[np.float64]  # (M, m) [N, N·m], −inf: no bound
    force_upper: NDArray[np.float64]  # (M, m)
    friction: NDArray[np.float64]  # (M,) μ of ‖(λ_x, λ_y)‖ ≤ μ λ_z, dimension 3 and 6; inf: no cone
    sliding_friction: NDArray[np.float64]  # (M,) μ at which the predicted contact slides, force feedback with Euler,
    # dimension 3 and 6; inf: it sticks
    def copy_node(self, source: int, target: int) -> None:
        """Copy all parameters of one node to another."""

class NodeResult:
    """What one node yields; arrays are copies. Derivatives are None after `calc`."""

    @property
    def cost(self) -> float: ...
    @property
    def x_next(self) -> NDArray[np.float64]: ...  # (nx,)
    @property
    def acceleration(self) -> NDArray[np.float64]: ...  # (n,) mean joint acceleration of the step [rad/s²]
    @property
    def force(self) -> NDArray[np.float64]: ...  # (m,) λ: state, or output of the rigid / naive contact
    @property
    def force_rate(self) -> NDArray[np.float64]: ...  # (m,) λ̇ of force feedback, zero otherwise
    @property
    def fx(self) -> NDArray[np.float64]: ...  # (nx, nx)
    @property
    def fu(self) -> NDArray[np.float64]: ...  # (nx, n)
    @property
    def Lx(self) -> NDArray[np.float64]: ...  # (nx,)
    @property
    def Lu(self) -> NDArray[np.float64]: ...  # (n,)
    @property
    def Lxx(self) -> NDArray[np.float64]: ...  # (nx, nx) Gauss–Newton, with all cross terms
    @property
    def Lxu(self) -> NDArray[np.float64]: ...  # (nx, n)
    @property
    def Luu(self) -> NDArray[np.float64]: ...  # (n, n)
    @property
    def force_x(self) -> NDArray[np.float64]: ...  # (m, nx) ∂λ/∂x
    @property
    def force_u(self) -> NDArray[np.float64]: ...  # (m, n) ∂λ/∂u

class Node:
    """One node by itself: for tests, the bridge, plots. `parameters` is a `Nodes` of one row."""

    def __init__(self, chain: Chain, model: Model, dt: float, *, terminal: bool = False) -> None: ...
    @property
    def parameters(self) -> Nodes: ...
    @property
    def nx(self) -> int: ...
    def freeze(self, q: ArrayLike) -> None:
        """Take the task inertia at `q` for the exponential integrator (a solver does it with its x0)."""
    def calc(self, x: ArrayLike, u: ArrayLike) -> NodeResult: ...
    def calc_diff(self, x: ArrayLike, u: ArrayLike) -> NodeResult: ...
    def benchmark(self, x: ArrayLike, u: ArrayLike, repetitions: int, *, derivatives: bool = True) -> float:
        """Seconds per evaluation, measured inside the extension over `repetitions` calls."""

class Solution:
    """Result of one solve; arrays are copies. u(x) ≈ us[0] − feedback_gain (x − xs[0])."""

    @property
    def status(self) -> Status: ...
    @property
    def xs(self) -> NDArray[np.float64]: ...  # (N+1, nx)
    @property
    def us(self) -> NDArray[np.float64]: ...  # (N, n)
    @property
    def forces(self) -> NDArray[np.float64]: ...  # (N, m) predicted λ at the running nodes
    @property
    def feedback_gain(self) -> NDArray[np.float64]: ...  # (n, nx)
    @property
    def iterations(self) -> int: ...  # SQP steps taken
    @property
    def evaluations(self) -> int: ...  # passes over the horizon with derivatives
    @property
    def qp_iterations(self) -> int: ...  # factorisations of the recursion, summed
    @property
    def kkt(self) -> float: ...  # ∞-norm of stationarity, gaps, and bound violation
    @property
    def cost(self) -> float: ...
    @property
    def gap(self) -> float: ...  # Σ_k ‖f(x_k, u_k) − x_{k+1}‖₁
    @property
    def violation(self) -> float: ...  # ∞-norm of the bound and cone violation [N·m, N]
    @property
    def solve_time(self) -> float: ...  # [s] wall time inside the solver

class Solver:
    """Stagewise SQP over N + 1 nodes. Keeps its plan between solves (warm start). One thread per solver."""

    def __init__(
        self,
        chain: Chain,
        model: Model,
        horizon: int,
        dt: float,
        *,
        regularisation: float = 1e-9,
        filter_size: int = 8,
        line_search_steps: int = 10,
        bounds: bool = False,
    ) -> None:
        """Allocate everything; nothing is allocated while solving.

        Args:
            chain: robot.
            model: which model.
            horizon: N ≥ 1 running nodes.
            dt: [s] step.
            regularisation: added to the diagonals of L_xx and L_uu (raised by itself when the recursion breaks down).
            filter_size: past (cost, infeasibility) pairs the line search compares with.
            line_search_steps: halvings tried per iteration.
            bounds: treat torque, force and cone bounds of `nodes` (else they are ignored, and cost nothing). Forces are
                bounded wherever they can be chosen: in force feedback at nodes 1 to N, with the classical model at
                nodes 0 to N − 1, with the others at nodes 1 to N − 1.
        """
    @property
    def nodes(self) -> Nodes:
        """Parameters of the N + 1 nodes (views: what is written counts at the next solve)."""
    @property
    def horizon(self) -> int: ...
    @property
    def dt(self) -> float: ...
    @property
    def nx(self) -> int: ...
    @property
    def nu(self) -> int: ...
    @property
    def xs(self) -> NDArray[np.float64]:
        """(N+1, nx) the plan, a copy; assign to set the initial guess."""
    @xs.setter
    def xs(self, value: ArrayLike) -> None: ...
    @property
    def us(self) -> NDArray[np.float64]:
        """(N, n) likewise."""
    @us.setter
    def us(self, value: ArrayLike) -> None: ...
    def shift(self) -> None:
        """Move the plan (and bound multipliers) one node ahead; the last control and state repeat."""
    def reset(self) -> None:
        """Forget multipliers of bounds (plan and nodes stay)."""
    def quasi_static(self, x0: ArrayLike) -> None:
        """Set the plan to rest at x0: every state x0, every control g(q) − Jᵀλ (λ of a force-feedback state, else 0).

        In torque feedback the torques of the planned states become g(q) too.
        """
    def solve(
        self,
        x0: ArrayLike,
        xs: ArrayLike | None = None,
        us: ArrayLike | None = None,
        *,
        max_iterations: int = 8,
        tolerance: float = 1e-4,
        time_budget: float | None = None,
    ) -> Solution:
        """Solve from the measured state; the GIL is released meanwhile.

        Args:
            x0: (nx,) measured state; becomes xs[0].
            xs: (N+1, nx) initial guess; the kept plan if None.
            us: (N, n) initial guess; the kept plan if None.
            max_iterations: SQP steps allowed.
            tolerance: KKT residual at which it stops.
            time_budget: [s] wall time after which no further iteration starts; None: no limit.
        """

Fault: TypeAlias = Literal[
    "no_wrench",  # force feedback, and the estimate has no wrench of the contact frame
    "no_disturbance",  # it is to be taken out, and the estimate has none
    "no_task",  # neither a preview nor a task for the frame
    "reference_not_finite",
    "pulls",  # a desired force points into the surface: value [N] along the normal
    "unknown_phase",  # a phase without costs
    "no_phase_for_contact",  # a reference without phases, and no phase with (value 1) or without (0) contact
]
Refusal: TypeAlias = tuple[Fault, int, float, tuple[float, float, float]]  # fault, node, value, normal

class ControllerState:
    """What a predictive controller keeps between two steps. A copy is a state of its own; it can be pickled."""

    @property
    def time_of_next_solve(self) -> float: ...  # [s]
    @property
    def source(self) -> int: ...  # of the last torque: 0 plan, 1 old plan, 2 gravity and damping
    @property
    def failures(self) -> int: ...  # solves in a row that left no usable solution
    @property
    def force_shift(self) -> float: ...  # [N] of the force reference
    @property
    def channels(self) -> Mapping[str, float | NDArray[np.float64]]: ...  # of the last solve, for the log
    @property
    def nodes(self) -> Nodes: ...  # parameters of the last solve, a copy
    @property
    def contact(self) -> Nodes: ...  # of the prediction over the delay, one row, a copy
    @property
    def xs(self) -> NDArray[np.float64]: ...  # (N+1, nx) the solver's plan, a copy
    @property
    def us(self) -> NDArray[np.float64]: ...  # (N, n) likewise
    @property
    def commands(self) -> NDArray[np.float64]: ...  # (under_way + 1, n) [N·m] sent, the oldest first
    def copy(self) -> ControllerState: ...

class ControllerStep:
    """A predictive controller between estimate and torque: one call, without the GIL, nothing taken from the heap.

    Measured state, references along the horizon, prediction over the delay, environment, disturbance, force integral,
    solve, plan and fallback, averaging. It keeps nothing from step to step: that is in `ControllerState`.
    """

    def __init__(
        self,
        chain: Chain,
        model: Model,
        nodes: Nodes,
        phases: Sequence[tuple[str, bool, Nodes]],
        *,
        frame: str,
        contact_frame: str,
        dt: float,
        period: float,
        tick: float,
        regularisation: float,
        bounds: bool,
        max_iterations: int,
        tolerance: float,
        time_budget: float | None,
        deadline: float | None,
        riccati: bool,
        interpolation: float,
        max_gap: float,
        fallback_damping: float,
        torque_limit: ArrayLike,
        R_world_surface: ArrayLike,
        stiffness_max: float,
        reference_posture: bool,
        task_velocity: bool,
        named_phases: bool,
        torque_bounds: bool,
        disturbance: bool,
        environment: bool,
        force_integral: float,
        force_shift_max: float,
        under_way: int,
        averaged: int,
        late: int,
        lead: float,
        environment_damping: bool = False,
    ) -> None:
        """Takes all that stays the same during a run.

        Args:
            chain: robot.
            model: which model.
            nodes: (N+1) what the nodes hold before the first step: contact, bounds.
            phases: name, whether it has contact, and (N+1) nodes with its weights.
            frame: whose task is tracked.
            contact_frame: whose wrench, contact and environment are read.
            dt: [s] between two nodes.
            period: [s] from solve to solve.
            tick: [s] from command to command.
            regularisation: as of `Solver`.
            bounds: as of `Solver`.
            max_iterations: as of `Solver.solve`.
            tolerance: as of `Solver.solve`.
            time_budget: as of `Solver.solve`.
            deadline: [s] of wall time after which a solve counts as missed; None: it is not looked at.
            riccati: between two solves the solver's own feedback, else the torque is held.
            interpolation: ε of [FFMPC] eq. 15, for 'torque_feedback'.
            max_gap: Σ|f(x, u) − x⁺| above which a solution is not used.
            fallback_damping: [N·m·s/rad] when no plan is left.
            torque_limit: (n,) [N·m].
            R_world_surface: (3, 3) with axes 'surface', where the task has none of its own.
            stiffness_max: [N/m] up to which an estimated stiffness is taken.
            reference_posture: posture of the reference, where it has one, else of the start.
            task_velocity: velocity costs about the task's velocity, else about zero.
            named_phases: costs by the reference's phase, else by the contact that is felt.
            torque_bounds: whether the limits are bounds of the problem.
            disturbance: take `Estimate.disturbance` out of the torque.
            environment: let `Estimate.environments` replace the stiffness, where there is one.
            force_integral: [1/s].
            force_shift_max: [N].
            under_way: periods between a reading and the effect of the command that answers to it.
            averaged: torques in the mean that is sent.
            late: periods by which averaging delays a torque.
            lead: [s] from an estimate to the effect of the command that answers to it.
            environment_damping: let it replace the damping, too, where that is known well enough.

        Raises:
            ValueError: sizes that do not belong together.
        """
    def init(self, time: float, q: ArrayLike, v: ArrayLike, torque_sent: ArrayLike) -> ControllerState: ...
    def step(
        self, estimate: object, reference: object, state: ControllerState, out: NDArray[np.float64]
    ) -> Refusal | None:
        """Steps; `state` is changed in place.

        Args:
            estimate: an `Estimate`, of now.
            reference: a `Reference`, of now; looked at only where a solve is due.
            state: of this controller.
            out: (3, n) written: torque, what the limits took away, disturbance, N·m.

        Returns:
            None, or why there is no answer; `out` is then not written.

        Raises:
            ValueError: an array of another shape, a reference that is no rotation, a state of another controller.
        """

def instruction_set() -> Literal["sse2", "neon", "avx2", "avx512"]:
    """The one in use: the widest this machine has, or what the environment variable PLIANT_ISA names."""

def available_instruction_sets() -> list[str]:
    """Those this library holds and this machine can run."""

def use_instruction_set(name: str) -> None:
    """Choose for objects made from now on (tests, benchmarks); ValueError lists the available ones."""

class StepPart(Part):
    """A controller's step as a part of a compiled loop, with one state, which it consumes."""

    def __init__(
        self,
        step: ControllerStep,
        state: ControllerState,
        places: Mapping[str, int],
        count: int,
        phase: str,
        names: Sequence[str],
        begin: int,
    ) -> None:
        """
        Args:
            step: the controller.
            state: of it.
            places: where a row has the signals, by the names in `PartPlaces` (cpp/mpc/binding/part.hpp); what is
                missing is not given.
            count: instants of the preview; 0: there is none.
            phase: of the reference.
            names: phases by number, as the preview has them.
            begin: where torque, clamped torque and diagnostics begin.

        Raises:
            ValueError: a state of another controller, or a place that is missing.
        """
