"""Names as users write them before they know the catalogue, and what they mean.

Written down before the scorer was: textbook symbols, words of machine designers, other spellings, typing errors. Each
phrase is of a mechanism; what is meant must be among the first three suggestions.
"""

#: Phrases for quantities, by mechanism: one `PHRASE -> NAME` a line.
QUANTITIES = {
    "planar_4r": """
        mu -> transmission_angle
        μ -> transmission_angle
        \\mu -> transmission_angle
        mu_min -> transmission_angle_min
        μ_min -> transmission_angle_min
        μmin -> transmission_angle_min
        min_transmission_angle -> transmission_angle_min
        transmission_angle_minimum -> transmission_angle_min
        minimum transmission angle -> transmission_angle_min
        transmission -> transmission_angle
        transmissionAngle -> transmission_angle
        trans_angle -> transmission_angle
        pressure angle -> transmission_angle
        mechanical advantage -> d_theta4_d_theta1
        velocity ratio -> d_theta4_d_theta1
        transmission ratio -> d_theta4_d_theta1
        torque -> T41
        torque_max -> T41_max
        max_torque -> T41_max
        maxTorque -> T41_max
        peak torque -> T41_max
        driving_torque -> T41
        drive torque -> T41
        input torque -> T41
        crank torque -> T41
        motor torque -> T41
        rms torque -> T41_rms
        rms(T41) -> T41_rms
        M41 -> T41
        T_41 -> T41
        T14 -> T41
        shaking force -> shaking_force
        shaking force max -> shaking_force_max
        shakingforce -> shaking_force
        F_shaking -> shaking_force
        shaking moment -> shaking_moment
        ground reaction -> F41
        bearing force -> F41
        bearing load -> F41
        force at O -> F41
        pin force at A -> F21
        reaction at B -> F32
        reaction at D -> F43
        F_41 -> F41
        F14 -> F41
        F41x -> F41_x
        w4 -> omega4
        ω4 -> omega4
        ω₄ -> omega4
        \\omega_4 -> omega4
        omega_4 -> omega4
        OMEGA4 -> omega4
        omeg4 -> omega4
        omgea4 -> omega4
        rocker speed -> omega4
        output speed -> omega4
        output angular velocity -> omega4
        angular velocity of the output link -> omega4
        angular velocity of coupler -> omega2
        omega3 -> omega2
        rocker angular acceleration -> alpha4
        output acceleration -> alpha4
        acceleration -> alpha4
        α4 -> alpha4
        coupler angle -> theta2
        output angle -> theta4
        rocker angle -> theta4
        follower angle -> theta4
        θ4 -> theta4
        th4 -> theta4
        psi -> theta4
        coupler point x -> P_x
        coupler_point_y -> P_y
        coupler curve -> P_x
        coupler point velocity -> P_speed
        P velocity x -> P_vx
        vPx -> P_vx
        coupler point acceleration -> P_ax
        position of B -> B_x
        Bx -> B_x
        max_omega4 -> omega4_max
        omega4max -> omega4_max
        maxomega4 -> omega4_max
        omega4_peak -> omega4_max
        peak omega4 -> omega4_max
        omega4_maximum -> omega4_max
        error of the greatest omega4 -> omega4_max_error
        max rocker speed -> omega4_max
        omega4_avg -> omega4_mean
        omega4_average -> omega4_mean
        mean(omega4) -> omega4_mean
        theta1_at_max_omega4 -> theta1_at_omega4_max
        argmax omega4 -> theta1_at_omega4_max
        omega4_argmax -> theta1_at_omega4_max
        crank angle of minimum transmission angle -> theta1_at_transmission_angle_min
        omega4_extremes -> omega4_extrema
        all extrema of T41 -> T41_extrema
        number of extrema of omega4 -> omega4_extrema_count
        domega4_da2 -> d_omega4_d_a2
        domega4/da2 -> d_omega4_d_a2
        dω4/da2 -> d_omega4_d_a2
        d omega4 d a2 -> d_omega4_d_a2
        derivative of omega4 with respect to a2 -> d_omega4_d_a2
        d_omega4_da2_max -> d_omega4_d_a2_max
        omega4_err -> omega4_error
        error_omega4 -> omega4_error
        grashof -> grashof_class
        crank-rocker -> grashof_class
        linkage type -> grashof_class
        swing angle -> swing
        rocker swing -> swing
        oscillation angle -> swing
        stroke -> swing
        quick return ratio -> time_ratio
        advance to return ratio -> time_ratio
        power -> input_power
        radius of curvature -> curvature
        jerk -> jerk4
        dead centre -> theta1_low
        toggle position -> theta1_high
        toggle angle -> theta1_low
        limit angles -> theta1_low
        assembles -> status
        feasible -> status
        joint angle -> joint_angle_1
        closure error -> loop_residual
        torque fluctuation -> T41_fluctuation
        coefficient of fluctuation -> T41_fluctuation
    """,
    "slider_crank": """
        omega4_max -> omega2_max
        mu_min -> transmission_angle_min
        piston velocity -> slider_velocity
        piston speed max -> slider_velocity_max
        piston position -> slider_position
        piston displacement -> slider_position
        piston acceleration max -> slider_acceleration_max
        acceleration of slider -> slider_acceleration
        x -> slider_position
        v_max -> slider_velocity_max
        a -> slider_acceleration
        side thrust -> side_force
        piston side force -> side_force
        connecting rod angle -> theta2
        conrod angular velocity -> omega2
        crank torque -> T41
        top dead center -> outer_dead_centre
        TDC -> outer_dead_centre
        BDC -> inner_dead_centre
        wrist pin force -> F32
        quick return -> time_ratio
        slider velocity rms -> slider_velocity_rms
        main bearing force -> F41
        dslider_position_dr -> d_slider_position_d_r
    """,
    "focal": """
        pressure angle -> transmission_angle_F
        F position -> F_x
        λ -> lambda_
        lambda -> lambda_
        velocity ratio -> dpsi_dphi
        ψ -> psi
        dψ/dφ -> dpsi_dphi
        straight line error -> F_path_residual
        crank angle -> sigma
    """,
    "hart": """
        straight line deviation -> F_deviation
        straightness -> F_deviation
        stroke length -> stroke
        point F -> F_x
        lambda -> lambda_
        velocity of F -> dF_y_dphi
    """,
    "minkowski_4r": """
        transmission angle -> zeta
        ζ -> zeta
        output angle -> psi
        coupler point -> X_x
        branching point -> theta_branching
        transmission ratio -> dpsi_dtheta
        coupler angle -> phi
    """,
}

#: Phrases for inputs, by mechanism.
INPUTS = {
    "planar_4r": """
        A1 -> a1
        a_1 -> a1
        l1 -> a1
        L2 -> a2
        length_crank -> a1
        crank_length -> a1
        crank -> a1
        input link -> a1
        coupler -> a2
        coupler length -> a2
        rocker -> a3
        output link -> a3
        follower length -> a3
        ground -> a4
        frame -> a4
        base -> a4
        fixed link -> a4
        w1 -> omega1
        ω1 -> omega1
        omega -> omega1
        rpm -> omega1
        speed -> omega1
        input speed -> omega1
        angular_velocity -> omega1
        rho -> density
        ρ -> density
        bar_radius -> radius
        diameter -> radius
        mass_crank -> m1
        M2 -> m2
        mass coupler -> m2
        inertia1 -> I1
        J2 -> I2
        moment of inertia of the output link -> I3
        g -> gravity_y
        gravity -> gravity_y
        G1 -> G1_u
        centre of mass of the coupler -> G2_u
        px -> P_u
        coupler point -> P_u
        load torque -> T_load
        T_out -> T_load
        alpha -> alpha1
        angular acceleration -> alpha1
        external force -> FP_x
    """,
    "slider_crank": """
        crank -> r
        crank radius -> r
        rod -> l
        connecting rod length -> l
        conrod -> l
        L -> l
        offset -> e
        eccentricity -> e
        piston mass -> m3
        load -> F_load
        gas force -> F_load
        w -> omega
        a1 -> r
    """,
    "hart": """
        k -> kappa
        κ -> kappa
        base length -> d
    """,
    "focal": """
        ground -> d
        ρ -> rho
        λ -> lambda_
        lambda -> lambda_
        coupler -> c
        angular velocity -> omega
    """,
    "minkowski_4r": """
        coupler -> h
        crank -> a
        ground -> g
        tol -> tolerance
    """,
}

#: Phrases for mechanisms.
MECHANISMS = """
    four_bar -> planar_4r
    fourbar -> planar_4r
    4bar -> planar_4r
    four-bar linkage -> planar_4r
    crank_rocker -> planar_4r
    planar4r -> planar_4r
    Planar_4R -> planar_4r
    4R -> planar_4r
    crank_slider -> slider_crank
    slidercrank -> slider_crank
    piston -> slider_crank
    engine -> slider_crank
    minkowski -> minkowski_4r
    lorentz -> minkowski_4r
    burmester -> focal
    six-bar -> hart
    straight line -> hart
"""


def pairs(lines: str) -> list[tuple[str, str]]:
    """Return the phrases of a table with what they mean."""
    rows = (line.rpartition(" -> ") for line in map(str.strip, lines.splitlines()) if line)
    return [(phrase, name) for phrase, _, name in rows]
