"""The formulas of the figures of runs, as LaTeX, by the names of their columns.

They say by symbols what the functions in bodycheck/figures/ compute.
"""

#: What the symbols are, as Markdown.
NOTATION = r"""
In the formulas a star marks the truth, and quantities without one are those of the run. $\mathbf r$ is the position of the
centre of mass and $\mathbf v$ its velocity, in the world frame; $q$ is the attitude as a unit quaternion, and
$\boldsymbol\omega$ the angular velocity in the body frame. $E$ is the mechanical energy, $T$ the kinetic energy, $R$ the
rotational energy, $\mathbf L$ the angular momentum about the centre of mass and $\mathbf P$ the linear momentum, in the
world frame. $m$ is the mass and $N$ the normal force. $\varepsilon$ is a bound of the truth's own error. The largest value
over $t$ is that over the sampled instants. Where the number that a figure is relative to is zero, another size takes its
place, such as the largest kinetic energy of the truth.
"""

#: The order of convergence and what is no figure has no formula.
FORMULAS = {
    "position_error": r"\max_t \lVert \mathbf r(t) - \mathbf r^*(t) \rVert",
    "velocity_error": r"\max_t \lVert \mathbf v(t) - \mathbf v^*(t) \rVert",
    "attitude_error": r"\max_t 2 \arccos \lvert q(t) \cdot q^*(t) \rvert",
    "angular_velocity_error": r"\max_t \lVert \boldsymbol\omega(t) - \boldsymbol\omega^*(t) \rVert",
    "energy_drift": r"\max_t \lvert E(t) - E(0) \rvert / T^*(0)",
    "rotational_energy_drift": r"\max_t \lvert R(t) - R(0) \rvert / R^*(0)",
    "angular_momentum_drift": r"\max_t \lVert \mathbf L(t) - \mathbf L(0) \rVert / \lVert \mathbf L^*(0) \rVert",
    "energy_error": r"\max_t \lvert E(t) - E^*(t) \rvert / T^*(0)",
    "rotational_energy_error": r"\max_t \lvert R(t) - R^*(t) \rvert / R^*(0)",
    "angular_momentum_error": r"\max_t \lVert \mathbf L(t) - \mathbf L^*(t) \rVert / \lVert \mathbf L^*(0) \rVert",
    "truth_error": r"\max_t \varepsilon_q(t)",
    "truth_position_error": r"\max_t \varepsilon_{\mathbf r}(t)",
    "truth_velocity_error": r"\max_t \varepsilon_{\mathbf v}(t)",
    "truth_angular_velocity_error": r"\max_t \varepsilon_{\boldsymbol\omega}(t)",
    "truth_energy_error": r"\max_t \varepsilon_E(t) / T^*(0)",
    "truth_angular_momentum_error": r"\max_t \varepsilon_{\mathbf L}(t) / \lVert \mathbf L^*(0) \rVert",
    "quaternion_norm_error": r"\max_t \bigl\lvert \lVert q(t) \rVert - 1 \bigr\rvert",
    "stop_time_error": r"\lvert t_\text{stop} - t_\text{stop}^* \rvert",
    "stop_position_error": r"\lVert (x, y)_\text{stop} - (x, y)_\text{stop}^* \rVert",
    "stop_yaw_error": r"\lvert \psi_\text{stop} - \psi_\text{stop}^* \rvert",
    "creep": r"\lVert (x, y)_\text{end} - (x, y)_\text{stop} \rVert / (t_\text{end} - t_\text{stop})",
    "penetration": r"\max_t (\text{depth of the lowest point below the plane})",
    "tilt": r"\max_t \arccos (\mathbf K(t) \cdot \mathbf n)",
    "mean_load": r"\bar N / m g",
    "peak_load": r"\max N / m g",
    "time_in_contact": r"n(N > 0) / n",
    "joint_position_error": r"\max_{t, j} \lvert \theta_j(t) - \theta_j^*(t) \rvert",
    "joint_slide_error": r"\max_{t, j} \lVert \mathbf d_j(t) - \mathbf d_j^*(t) \rVert",
    "constraint_error": r"\max_{t, j} \lVert \mathbf p_j^\text{parent}(t) - \mathbf p_j^\text{child}(t) \rVert",
    "momentum_drift": (
        r"\max_t \max \left( \lVert \mathbf L(t) - \mathbf L(0) \rVert / \lVert \mathbf L^*(0) \rVert, "
        r"\lVert \mathbf P(t) - \mathbf P(0) \rVert / m \max_t \lVert \mathbf v^* \rVert \right)"
    ),
    "limit_violation": r"\max_{t, j} \max(q_j(t) - q_j^\text{upper}, q_j^\text{lower} - q_j(t), 0)",
    "transition_time_error": r"\lvert t_\text{roll} - t_\text{roll}^* \rvert",
    "roll_speed_error": r"\lVert \mathbf v(t_\text{roll}) - \mathbf v^*(t_\text{roll}^*) \rVert",
    "impact_time_error": r"\lvert t_1 - t_1^* \rvert",
    "impact_speed_error": r"\lVert \mathbf v(t_1^+) - \mathbf v^*(t_1^{*+}) \rVert",
    "bounce_ratio_error": r"\max_k \lvert v_n(t_k^+) / v_n(t_k^-) - e \rvert",
    "rest_time_error": r"\lvert t_\text{rest} - t_\text{rest}^* \rvert",
    "impact_energy_error": r"\max_k \lvert \Delta E_k / T(t_k^-) - \Delta E_k^* / T^*(t_k^{*-}) \rvert",
    "impact_momentum_error": (
        r"\max_{k, b} \lVert \Delta \mathbf P_{k, b} / \sum_b \lVert \mathbf P_b(t_k^-) \rVert - "
        r"\Delta \mathbf P_{k, b}^* / \sum_b \lVert \mathbf P_b^*(t_k^{*-}) \rVert \rVert"
    ),
    "viscous_speed": r"\max \{ v : -\dot v(v') < 0.9\, \lvert \dot v^* \rvert \;\forall\, v' \le v \}",
    "energy_gain": r"\max_{t \ge s} (E(t) - E(s)) / \max_t E^*(t)",
    "load_error": r"\max \lvert \bar N - N^* \rvert / N^*",
    "contact_losses": r"n(N = 0 \text{ after } N > 0)",
    "sensor_error": (
        r"\max_s \left( \max_t \lVert \mathbf s(t) - \mathbf s^*(t) \rVert / \max_t \lVert \mathbf s^*(t) \rVert \right)"
    ),
}
